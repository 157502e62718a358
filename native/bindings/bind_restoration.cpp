#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/restoration_part.hpp"
#include "model/colours.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::require;

namespace {

using Tile = Array<const float, 3>;
using Change = Array<const int32_t, 2>;

sgi::Restoration restoration_of(const Tile &drawn, const sgi::RestorationChoice &choice, const std::string &isa) {
  const size_t channels = drawn.shape(0), rows = drawn.shape(1), columns = drawn.shape(2), pixels = rows * columns;
  require(channels >= 1 && channels <= 64 && pixels > 0 && pixels < (size_t(1) << 31), "a tile must have pixels");
  require(choice.step >= 0 && choice.step < 512, "step must be 0..511");
  return {sgi::restoration_network(choice),
          choice.step,
          int(channels),
          sgi::texture_mix(int(channels), false),
          int64_t(columns),
          int64_t(rows),
          sgi::choose_isa(isa)};
}

sgi::TileBlock whole(const Tile &drawn) { return {0, 0, int64_t(drawn.shape(2)), int64_t(drawn.shape(1))}; }

sgi::RestorationChoice choice_of(int network, int step, const std::vector<Change> &changes) {
  sgi::RestorationChoice choice{network, step, {}};
  if (changes.empty()) return choice;
  const auto shipped = sgi::restoration_network(choice);
  require(changes.size() == shipped->layers.size(), "changes must be as many as layers");
  for (size_t i = 0; i < changes.size(); ++i) {
    const size_t inputs = shipped->layers[i].inputs, outputs = shipped->layers[i].outputs;
    require(!changes[i].size() || sgi::has_shape(changes[i], outputs, inputs * sgi::kRestorationTaps + 1),
            "changes must be [outputs, 9 * inputs + 1]");
    choice.changes.emplace_back(changes[i].data(), changes[i].data() + changes[i].size());
  }
  return choice;
}

// What a whole tile gets, drawn in the channels that its stream codes.
auto restoration_correction(Tile drawn, int network, int step, const std::vector<Change> &changes, int threads,
                            const std::string &isa) {
  const sgi::Restoration restoration = restoration_of(drawn, choice_of(network, step, changes), isa);
  std::vector<float> planes(drawn.size());
  {
    nb::gil_scoped_release release;
    restoration.correct(sgi::in_planes(drawn.data(), whole(drawn)), threads,
                        sgi::in_planes(planes.data(), whole(drawn)));
  }
  return sgi::as_array<float>(std::move(planes),
                              std::array{size_t(drawn.shape(0)), size_t(drawn.shape(1)), size_t(drawn.shape(2))});
}

// What the last layer of the shipped network sees around some rows of a tile.
auto restoration_last_inputs(Tile drawn, int network, int step, int64_t top, int64_t rows, int threads,
                             const std::string &isa) {
  const sgi::Restoration restoration = restoration_of(drawn, {network, step, {}}, isa);
  require(top >= 0 && rows >= 1 && top + rows <= int64_t(drawn.shape(1)), "rows of the tile");
  std::vector<int16_t> found;
  {
    nb::gil_scoped_release release;
    found = restoration.last_inputs(sgi::in_planes(drawn.data(), whole(drawn)), top, rows, threads);
  }
  const size_t height = size_t(rows) + 2, width = drawn.shape(2) + 2, channels = found.size() / (height * width);
  return sgi::as_array<int16_t>(std::move(found), std::array{channels, height, width});
}

// The shipped network's last layer [outputs, 9 * inputs + 1]: weights of an output, then its bias, and the shift of
// what it gives.
auto restoration_last_layer(int network) {
  const auto shipped = sgi::restoration_network({network, 0, {}});
  const sgi::RestorationLayer &layer = shipped->layers.back();
  const size_t outputs = layer.outputs, columns = size_t(layer.inputs) * sgi::kRestorationTaps + 1;
  std::vector<int32_t> values;
  for (int o = 0; o < layer.outputs; ++o) {
    for (int i = 0; i < layer.inputs; ++i)
      for (int tap = 0; tap < sgi::kRestorationTaps; ++tap) values.push_back(layer.weight(o, i, tap));
    values.push_back(layer.bias(o));
  }
  return std::pair(sgi::as_array<int32_t>(std::move(values), std::array{outputs, columns}), shipped->shift);
}

}  // namespace

void bind_restoration(nb::module_ &m) {
  m.def(
      "restoration_correction", &restoration_correction, "drawn"_a, "network"_a, "step"_a, "changes"_a, "threads"_a,
      "isa"_a,
      "What restoration adds to a tile drawn as [C, H, W]. changes: by layer what is added to its weights and biases "
      "[outputs, 9 * inputs + 1], [0, 0] for nothing; none for no layer. Raises UnsupportedStreamError for an unknown "
      "network and CorruptStreamError for weights that it cannot have.");
  m.def("restoration_last_inputs", &restoration_last_inputs, "drawn"_a, "network"_a, "step"_a, "top"_a, "rows"_a,
        "threads"_a, "isa"_a,
        "What the last layer of a network sees around some rows of a tile drawn as [C, H, W]: [channels, rows + 2, "
        "W + 2].");
  m.def("restoration_last_layer", &restoration_last_layer, "network"_a,
        "Weights and then bias of each output [outputs, 9 * inputs + 1], and the shift of what they give.");
}
