#include "bind_bitstream.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>

#include <stdexcept>

#include "base_planes.hpp"
#include "grouping.hpp"

namespace nb = nanobind;

namespace {

template <class T, int D>
using Array = nb::ndarray<T, nb::ndim<D>, nb::c_contig, nb::device::cpu>;

void require(bool ok, const char *what) {
  if (!ok) throw std::invalid_argument(what);
}

void group_by_key(Array<const int16_t, 1> keys, Array<int32_t, 1> order, Array<int64_t, 1> start) {
  const size_t n = keys.shape(0), count = start.shape(0) - 1;
  require(start.shape(0) >= 1 && order.shape(0) == n && n < (size_t(1) << 31), "order [n], start [count + 1]");
  for (size_t i = 0; i < n; ++i)
    require(keys.data()[i] >= 0 && size_t(keys.data()[i]) < count, "a key is outside 0..count-1");
  sgi::group_by_key(keys.data(), int64_t(n), int(count), order.data(), start.data());
}

std::pair<double, int64_t> ungroup_symbols(Array<const int32_t, 1> indices, Array<const int32_t, 1> order,
                                           Array<const int16_t, 1> tables, Array<const int32_t, 1> support,
                                           Array<const int64_t, 1> start, Array<const double, 1> bits,
                                           Array<int32_t, 1> symbols) {
  const size_t n = indices.shape(0), count = support.shape(0);
  require(order.shape(0) == n && tables.shape(0) == n && symbols.shape(0) == n && start.shape(0) == count,
          "indices, order, tables and symbols [n]; support and start [tables]");
  for (size_t t = 0; t < count; ++t)
    require(start.data()[t] >= 0 && size_t(start.data()[t]) + 2 * size_t(support.data()[t]) + 2 <= bits.shape(0),
            "a table exceeds bits");
  for (size_t i = 0; i < n; ++i) {
    require(order.data()[i] >= 0 && size_t(order.data()[i]) < n, "order must be positions");
    const int16_t table = tables.data()[order.data()[i]];
    require(table >= 0 && size_t(table) < count, "tables must be numbers of tables");
    require(indices.data()[i] >= 0 && indices.data()[i] <= 2 * support.data()[table] + 1, "an index is in no table");
  }
  const sgi::SymbolTables all{support.data(), start.data(), bits.data()};
  const sgi::Symbols found =
      sgi::ungroup_symbols(indices.data(), order.data(), tables.data(), int64_t(n), all, symbols.data());
  return {found.bits, found.escapes};
}

double ungroup_categorical(Array<const int32_t, 1> indices, Array<const int32_t, 1> order, Array<const int16_t, 1> keys,
                           Array<const int32_t, 2> alphabets, Array<const double, 2> bits, Array<int32_t, 1> symbols) {
  const size_t n = indices.shape(0), rows = alphabets.shape(0), size = alphabets.shape(1);
  require(order.shape(0) == n && keys.shape(0) == n && symbols.shape(0) == n && bits.shape(0) == rows &&
              bits.shape(1) == size,
          "indices, order, keys and symbols [n]; alphabets and bits [contexts, A]");
  for (size_t i = 0; i < alphabets.size(); ++i)
    require(alphabets.data()[i] >= 0 && size_t(alphabets.data()[i]) < size, "alphabets must hold symbols");
  for (size_t i = 0; i < n; ++i)
    require(order.data()[i] >= 0 && size_t(order.data()[i]) < n && keys.data()[i] >= 0 &&
                size_t(keys.data()[i]) < rows && indices.data()[i] >= 0 && size_t(indices.data()[i]) < size,
            "an index is in no alphabet");
  return sgi::ungroup_categorical(indices.data(), order.data(), keys.data(), int64_t(n), alphabets.data(), bits.data(),
                                  int64_t(size), symbols.data());
}

bool add_predictions(Array<int64_t, 2> plane, int predictor, int64_t most) {
  require(predictor >= 0 && predictor < 4, "predictor must be 0..3");
  return sgi::add_predictions(plane.data(), int64_t(plane.shape(0)), int64_t(plane.shape(1)), predictor, most);
}

}  // namespace

void bind_bitstream(nb::module_ &m) {
  m.def("group_by_key", &group_by_key);
  m.def("ungroup_symbols", &ungroup_symbols);
  m.def("ungroup_categorical", &ungroup_categorical);
  m.def("add_predictions", &add_predictions);
  bind_tree(m);
}
