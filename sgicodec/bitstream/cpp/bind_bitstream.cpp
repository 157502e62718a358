#include "bind_bitstream.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <stdexcept>

#include "base_planes.hpp"
#include "grouping.hpp"
#include "tree_inputs.hpp"

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

using SplitNodes = std::tuple<Array<const int32_t, 1>, Array<const int32_t, 1>, Array<const int32_t, 2>,
                              Array<const uint8_t, 2>, Array<const uint8_t, 2>>;
using Slots = std::tuple<Array<const uint8_t, 2>, Array<const uint8_t, 2>, Array<const uint8_t, 2>>;

template <class A>
bool has_shape(const A &array, size_t rows, size_t columns) {
  return array.shape(0) == rows && array.shape(1) == columns;
}

sgi::SplitNodes checked(const SplitNodes &nodes) {
  const auto &[x, y, neighbour, beside, around] = nodes;
  const size_t count = x.shape(0);
  require(count < (size_t(1) << 28) && y.shape(0) == count && has_shape(neighbour, count, sgi::kSides) &&
              has_shape(beside, count, sgi::kBeside) && has_shape(around, count, sgi::kAround),
          "x, y [P]; neighbour [P, 8]; beside [P, 25]; around [P, 6]");
  for (size_t i = 0; i < neighbour.size(); ++i)
    require(neighbour.data()[i] >= 0 && size_t(neighbour.data()[i]) <= count, "neighbours must be indices, or P");
  return {x.data(), y.data(), neighbour.data(), beside.data(), around.data(), int64_t(count)};
}

sgi::Slots checked(const Slots &slots, int64_t count) {
  const auto &[exists, split, seed] = slots;
  for (const auto *array : {&exists, &split, &seed}) require(has_shape(*array, size_t(count) + 1, 4), "slots [P + 1, 4]");
  return {exists.data(), split.data(), seed.data()};
}

void base_detail(Array<const int64_t, 3> base, Array<int16_t, 3> out) {
  require(out.shape(0) == base.shape(1) && out.shape(1) == base.shape(2) && out.shape(2) == sgi::kDetail,
          "out must be [rows, columns, 5]");
  nb::gil_scoped_release release;
  sgi::base_detail(base.data(), int64_t(base.shape(0)), int64_t(base.shape(1)), int64_t(base.shape(2)), out.data());
}

void tree_inputs(const SplitNodes &nodes, const Slots &states, Array<const int16_t, 3> detail, int cell,
                 Array<const int16_t, 1> head, int level, int child, Array<const int32_t, 1> members,
                 Array<int16_t, 2> out) {
  const sgi::SplitNodes parents = checked(nodes);
  const sgi::Slots slots = checked(states, parents.count);
  require(child >= 0 && child < 4 && level >= 0 && level <= 16 && cell >= 1, "child 0..3, level 0..16, cell from 1");
  require(head.shape(0) == sgi::kHead && detail.shape(2) == sgi::kDetail, "head [11], detail [rows, columns, 5]");
  require(has_shape(out, members.shape(0), size_t(sgi::tree_input_count(child))), "out must be [n, inputs]");
  for (size_t i = 0; i < members.size(); ++i)
    require(members.data()[i] >= 0 && members.data()[i] < parents.count, "members must be indices");
  const sgi::BaseDetail base{detail.size() ? detail.data() : nullptr, int64_t(detail.shape(0)),
                             int64_t(detail.shape(1)), cell};
  nb::gil_scoped_release release;
  sgi::tree_inputs(parents, slots, base, head.data(), level, child, members.data(), int64_t(members.shape(0)),
                   out.data());
}

void split_children(const SplitNodes &nodes, const Slots &states, Array<const int32_t, 1> found,
                    Array<int32_t, 2> number, Array<int32_t, 1> x, Array<int32_t, 1> y, Array<int32_t, 2> neighbour,
                    Array<uint8_t, 2> beside, Array<uint8_t, 2> around) {
  const sgi::SplitNodes parents = checked(nodes);
  const sgi::Slots slots = checked(states, parents.count);
  const size_t m = found.shape(0);
  require(has_shape(number, size_t(parents.count) + 1, 4) && x.shape(0) == m && y.shape(0) == m &&
              has_shape(neighbour, m, sgi::kSides) && has_shape(beside, m, sgi::kBeside) &&
              has_shape(around, m, sgi::kAround),
          "outputs must be as of split nodes");
  for (size_t i = 0; i < m; ++i)
    require(found.data()[i] >= 0 && found.data()[i] < 4 * parents.count, "found must be slots");
  nb::gil_scoped_release release;
  sgi::split_children(parents, slots, found.data(), int64_t(m), number.data(), x.data(), y.data(), neighbour.data(),
                      beside.data(), around.data());
}

}  // namespace

void bind_bitstream(nb::module_ &m) {
  m.def("group_by_key", &group_by_key);
  m.def("ungroup_symbols", &ungroup_symbols);
  m.def("ungroup_categorical", &ungroup_categorical);
  m.def("add_predictions", &add_predictions);
  m.def("tree_input_count", &sgi::tree_input_count);
  m.def("base_detail", &base_detail);
  m.def("tree_inputs", &tree_inputs);
  m.def("split_children", &split_children);
}
