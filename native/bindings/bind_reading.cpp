#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "bitstream/read_attributes.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::has_shape;
using sgi::require;

namespace {

template <class T>
std::vector<T> copied(const Array<const T, 1> &array) {
  return {array.data(), array.data() + array.size()};
}

// The zero-centred tables as an object of their own.
class ZeroCentredTables {
 public:
  ZeroCentredTables(const sgi::SymbolModels &models, Array<const int32_t, 1> support, Array<const int64_t, 1> start,
                    Array<const double, 1> bits, const sgi::SymbolModels &exponents, int most)
      : support_(copied(support)), start_(copied(start)), bits_(copied(bits)),
        models_{&models, {support_.data(), start_.data(), bits_.data()}, &exponents, most} {
    const auto count = size_t(models.size());
    require(support.size() == count && start.size() == count, "support and start [tables]");
    for (size_t t = 0; t < count; ++t) {
      const int64_t symbols = 2 * int64_t(support_[t]) + 2;
      require(support_[t] >= 0 && models.symbols(int64_t(t)) == symbols && start_[t] >= 0 &&
                  size_t(start_[t] + symbols) <= bits.size(),
              "table t must have 2 support[t] + 2 symbols, and bits for them");
    }
    require(exponents.size() == 1 && exponents.symbols(0) <= 22, "one model of at most 22 exponents");
  }

  const sgi::ZeroCentred &models() const { return models_; }

 private:
  std::vector<int32_t> support_;
  std::vector<int64_t> start_;
  std::vector<double> bits_;
  sgi::ZeroCentred models_;
};

void require_keys(const Array<const int16_t, 1> &keys, size_t symbols, int64_t count) {
  require(keys.size() == symbols && symbols < (size_t(1) << 31), "keys and symbols [n]");
  for (size_t i = 0; i < keys.size(); ++i)
    require(keys.data()[i] >= 0 && keys.data()[i] < count, "a key is outside 0..count-1");
}

std::tuple<int, double> read_zero_centred(sgi::RangeDecoder &decoder, const ZeroCentredTables &tables,
                                          Array<const int16_t, 1> keys, Array<int32_t, 1> symbols) {
  require_keys(keys, symbols.size(), tables.models().models->size());
  double bits = 0;
  nb::gil_scoped_release release;
  const sgi::Reading reading =
      sgi::read_zero_centred(decoder, tables.models(), keys.data(), int64_t(keys.size()), symbols.data(), bits);
  return {int(reading), bits};
}

// The model of attributes, built piece by piece; everything is checked here.
class AttributeModel {
 public:
  AttributeModel(int64_t attributes, int per_seed, int channels, int colour, int shape, int quality, int ranks,
                 int first_table) {
    require(per_seed >= 1 && channels >= 1 && colour >= 0 && shape >= 0 &&
                colour + int64_t(per_seed) * channels <= attributes && shape + 3 * int64_t(per_seed) <= attributes,
            "the groups do not fit the attributes");
    require(ranks >= 0 && ranks <= sgi::kMostNeighbours && first_table >= 0 && first_table < 1 << 14,
            "at most 6 neighbours; tables from 0");
    model_.attributes = attributes, model_.per_seed = per_seed, model_.channels = channels, model_.colour = colour;
    model_.shape = shape, model_.quality = quality, model_.ranks = ranks, model_.first_table = int16_t(first_table);
  }

  AttributeModel(const AttributeModel &) = delete;

  void add_step(Array<const int64_t, 2> w1, Array<const int64_t, 1> b1, Array<const int64_t, 2> w2,
                Array<const int64_t, 1> b2, int shift, int predicted, const std::string &isa) {
    const sgi::NetworkWeights weights = sgi::network_weights(w1, b1, w2, b2, shift, predicted);
    require(2 * predicted <= weights.outputs, "there must be a mean and a scale for each prediction");
    const auto inputs = int64_t(w1.shape(1));
    const int64_t seed = sgi::kLevelInputs + (model_.ranks ? sgi::kNeighbourInputs : 0);
    const size_t number = model_.steps.size();
    require(number ? inputs >= model_.steps[0].inputs + sgi::own_input_count(int(number)) : inputs >= seed,
            "inputs have no room");
    model_.steps.push_back({std::make_unique<sgi::Network>(weights, sgi::choose_isa(isa)), int(inputs), predicted, {}});
  }

  void add_group(Array<const int64_t, 2> base, Array<const int64_t, 1> columns, int64_t gamma, bool follows_amplitude,
                 int64_t prediction, int64_t units, int64_t refinement, int64_t first) {
    require(!model_.steps.empty(), "a group belongs to a step");
    sgi::AttributeStep &step = model_.steps.back();
    const size_t size = columns.size();
    require(has_shape(base, size, sgi::kLevels) && first >= 0 && first + int64_t(size) <= model_.attributes,
            "base [size, 8], columns [size], within the attributes");
    for (size_t i = 0; i < base.size(); ++i)
      require(base.data()[i] >= 0 && base.data()[i] < sgi::kStepCount, "a base step is outside the table of steps");
    for (size_t i = 0; i < size; ++i)
      require(columns.data()[i] >= 0 && columns.data()[i] < units, "columns must be predictions");
    require(prediction >= 0 && prediction + units <= step.predicted && refinement >= 0 &&
                2 * step.predicted + refinement < step.network->outputs(),
            "a group must have outputs of its step");
    require(!follows_amplitude || model_.steps.size() > 1, "the amplitude is not known in the first step");
    step.groups.push_back({{base.data(), base.data() + base.size()},
                           copied(columns),
                           gamma,
                           follows_amplitude,
                           prediction,
                           refinement,
                           first});
  }

  // passes: members [sum n] of all passes one after the other, each ascending, and where each begins [passes + 1].
  auto read(sgi::RangeDecoder &decoder, const ZeroCentredTables &tables, Array<const int32_t, 2> half_pixels,
            Array<const int8_t, 1> log_size, Array<const int64_t, 1> members, Array<const int64_t, 1> start,
            int threads, Array<int64_t, 2> decoded) const {
    const size_t count = log_size.size();
    require(has_shape(half_pixels, count, 2) && has_shape(decoded, count, size_t(model_.attributes)),
            "half_pixels [N, 2], log_size [N], decoded [N, attributes]");
    require(model_.first_table + sgi::kScaleCount <= tables.models().models->size(), "a family of 64 tables");
    sgi::TileSeeds seeds{{half_pixels.data(), log_size.data()}, int64_t(count), {}};
    require(start.size() >= 1 && start.data()[0] == 0 && start.data()[start.size() - 1] == int64_t(members.size()),
            "start [passes + 1] must divide members");
    for (size_t i = 0; i < members.size(); ++i)
      require(members.data()[i] >= 0 && size_t(members.data()[i]) < count, "members must be indices of seeds");
    for (size_t p = 0; p + 1 < start.size(); ++p) {
      require(start.data()[p] <= start.data()[p + 1], "start must not fall");
      seeds.passes.emplace_back(members.data() + start.data()[p], members.data() + start.data()[p + 1]);
    }
    sgi::AttributesRead found;
    sgi::Reading reading;
    {
      nb::gil_scoped_release release;
      reading = sgi::read_attributes(decoder, model_, tables.models(), seeds, threads, decoded.data(), found);
    }
    const size_t n = found.symbols.size();
    return std::tuple(int(reading), as_array<int32_t>(std::move(found.symbols), std::array{n}), found.bits);
  }

 private:
  sgi::AttributeModel model_;
};

}  // namespace

void bind_reading(nb::module_ &m) {
  using Numbers = Array<const int64_t, 1>;
  nb::class_<ZeroCentredTables>(m, "ZeroCentredTables")
      .def(nb::init<const sgi::SymbolModels &, Array<const int32_t, 1>, Numbers, Array<const double, 1>,
                    const sgi::SymbolModels &, int>(),
           nb::keep_alive<1, 2>(), nb::keep_alive<1, 6>(), "models"_a, "support"_a, "start"_a, "bits"_a, "exponents"_a,
           "most"_a);
  m.def("read_zero_centred", &read_zero_centred, "decoder"_a, "tables"_a, "keys"_a, "symbols"_a,
        "0, or 1 where the payload does not decode, 2 where a symbol is too large; information content.");
  nb::class_<AttributeModel>(m, "AttributeModel")
      .def(nb::init<int64_t, int, int, int, int, int, int, int>(), "attributes"_a, "per_seed"_a, "channels"_a,
           "colour"_a, "shape"_a, "quality"_a, "neighbours"_a, "first_table"_a)
      .def("add_step", &AttributeModel::add_step, "w1"_a, "b1"_a, "w2"_a, "b2"_a, "shift"_a, "predicted"_a, "isa"_a)
      .def("add_group", &AttributeModel::add_group, "base"_a, "columns"_a, "gamma"_a, "follows_amplitude"_a,
           "prediction"_a, "units"_a, "refinement"_a, "first"_a)
      .def("read", &AttributeModel::read, "decoder"_a, "tables"_a, "half_pixels"_a, "log_size"_a, "members"_a,
           "start"_a, "threads"_a, "decoded"_a,
           "As of `read_zero_centred`, all symbols in coding order, information content by group.");
}
