#include <nanobind/stl/pair.h>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/base_planes.hpp"
#include "bitstream/grouping.hpp"
#include "bitstream/range_decoder.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::require;

namespace {

void group_by_key(Array<const int16_t, 1> keys, Array<int32_t, 1> order, Array<int64_t, 1> start) {
  const size_t n = keys.shape(0), count = start.shape(0) - 1;
  require(start.shape(0) >= 1 && order.shape(0) == n && n < (size_t(1) << 31), "order [n], start [count + 1]");
  for (size_t i = 0; i < n; ++i)
    require(keys.data()[i] >= 0 && size_t(keys.data()[i]) < count, "a key is outside 0..count-1");
  nb::gil_scoped_release release;
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
  nb::gil_scoped_release release;
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
  nb::gil_scoped_release release;
  return sgi::ungroup_categorical(indices.data(), order.data(), keys.data(), int64_t(n), alphabets.data(), bits.data(),
                                  int64_t(size), symbols.data());
}

void make_models(sgi::SymbolModels *self, Array<const int64_t, 1> frequency, Array<const int64_t, 1> start) {
  const size_t models = start.shape(0) - 1;
  require(start.shape(0) >= 1 && start.data()[0] >= 0 && size_t(start.data()[models]) <= frequency.shape(0),
          "start [models + 1] must lie within frequency");
  for (size_t k = 0; k < models; ++k) {
    require(start.data()[k] < start.data()[k + 1] && start.data()[k + 1] - start.data()[k] < (1 << 16),
            "a model must have 1 to 65535 symbols");
    int64_t sum = 0;
    for (int64_t i = start.data()[k]; i < start.data()[k + 1]; ++i) {
      require(frequency.data()[i] >= 0 && frequency.data()[i] <= 1 << 24, "a frequency is outside 0..2**24");
      sum += frequency.data()[i];
    }
    require(sum == 1 << 24, "the frequencies of a model must sum to 2**24");
  }
  new (self) sgi::SymbolModels(frequency.data(), start.data(), int64_t(models));
}

bool decode_symbols(sgi::RangeDecoder &self, const sgi::SymbolModels &models, Array<const int64_t, 1> start,
                    Array<int32_t, 1> out) {
  const int64_t keys = models.size();
  require(int64_t(start.shape(0)) == keys + 1 && start.data()[0] == 0 && start.data()[keys] == int64_t(out.shape(0)),
          "start [models + 1] must divide out");
  for (int64_t k = 0; k < keys; ++k) require(start.data()[k] <= start.data()[k + 1], "start must not fall");
  nb::gil_scoped_release release;
  return self.decode(models, start.data(), keys, out.data());
}

bool decode_uniform(sgi::RangeDecoder &self, int bits, Array<int32_t, 1> out) {
  require(bits >= 1 && bits <= 16, "bits must be 1..16");
  nb::gil_scoped_release release;
  return self.decode_uniform(bits, int64_t(out.shape(0)), out.data());
}

bool add_predictions(Array<int64_t, 2> plane, int predictor, int64_t most) {
  require(predictor >= 0 && predictor < 4, "predictor must be 0..3");
  nb::gil_scoped_release release;
  return sgi::add_predictions(plane.data(), int64_t(plane.shape(0)), int64_t(plane.shape(1)), predictor, most);
}

}  // namespace

void bind_bitstream(nb::module_ &m) {
  nb::class_<sgi::SymbolModels>(m, "SymbolModels").def("__init__", &make_models, "frequency"_a, "start"_a);
  nb::class_<sgi::RangeDecoder>(m, "RangeDecoder")
      .def(
          "__init__",
          [](sgi::RangeDecoder *self, nb::bytes payload) {
            new (self) sgi::RangeDecoder(static_cast<const uint8_t *>(payload.data()), int64_t(payload.size()));
          },
          "payload"_a)
      .def("decode", &decode_symbols, "models"_a, "start"_a, "out"_a)
      .def("decode_uniform", &decode_uniform, "bits"_a, "out"_a)
      .def("maybe_exhausted", &sgi::RangeDecoder::maybe_exhausted);
  m.def("group_by_key", &group_by_key, "keys"_a, "order"_a, "start"_a);
  m.def("ungroup_symbols", &ungroup_symbols, "indices"_a, "order"_a, "tables"_a, "support"_a, "start"_a, "bits"_a,
        "symbols"_a);
  m.def("ungroup_categorical", &ungroup_categorical, "indices"_a, "order"_a, "keys"_a, "alphabets"_a, "bits"_a,
        "symbols"_a);
  m.def("add_predictions", &add_predictions, "plane"_a, "predictor"_a, "most"_a);
}
