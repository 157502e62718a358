#include <nanobind/stl/string.h>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/restoration_part.hpp"
#include "model/colours.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::require;

namespace {

// What a whole tile gets, drawn in the channels that its stream codes.
auto restoration_correction(Array<const float, 3> drawn, int network, int step, int threads, const std::string &isa) {
  const size_t channels = drawn.shape(0), rows = drawn.shape(1), columns = drawn.shape(2), pixels = rows * columns;
  require(channels >= 1 && channels <= 64 && pixels > 0 && pixels < (size_t(1) << 31), "a tile must have pixels");
  require(step >= 0 && step < 512, "step must be 0..511");
  const sgi::Isa chosen = sgi::choose_isa(isa);
  std::vector<float> planes(channels * pixels);
  {
    nb::gil_scoped_release release;
    const sgi::Restoration restoration(sgi::restoration_network(network), step, int(channels),
                                       sgi::texture_mix(int(channels), false), int64_t(columns), int64_t(rows), chosen);
    std::vector<float> values(channels * pixels), correction(channels * pixels, 0.0f);
    for (size_t c = 0; c < channels; ++c)
      for (size_t i = 0; i < pixels; ++i) values[i * channels + c] = drawn.data()[c * pixels + i];
    restoration.correct(values.data(), threads, correction.data());
    for (size_t c = 0; c < channels; ++c)
      for (size_t i = 0; i < pixels; ++i) planes[c * pixels + i] = correction[i * channels + c];
  }
  return sgi::as_array<float>(std::move(planes), std::array{channels, rows, columns});
}

}  // namespace

void bind_restoration(nb::module_ &m) {
  m.def("restoration_correction", &restoration_correction, "drawn"_a, "network"_a, "step"_a, "threads"_a, "isa"_a,
        "What restoration adds to a tile drawn as [C, H, W]. Raises UnsupportedStreamError for an unknown network.");
}
