#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "base/crc32.hpp"
#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/residual_layer.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::require;

namespace {

using Samples = Array<const uint16_t, 3>;

// Bits of a block, their P(1) in 2^-16, the CRC-32 of what a reader finds.
auto code_residual(Samples samples, Samples drawn, nb::bytes header, int32_t max_error) {
  for (size_t axis = 0; axis < 3; ++axis)
    require(samples.shape(axis) == drawn.shape(axis), "samples and drawn have one shape");
  const sgi::Header whole = sgi::decode_header({static_cast<const uint8_t *>(header.data()), header.size()});
  require(int(samples.shape(2)) == whole.spec.channels, "as many channels as the header has");
  require(samples.size() > 0 && max_error >= 0 && max_error < int32_t(largest_of(whole.sample_type)),
          "a block has pixels, and its greatest error is less than the largest sample");
  const auto shape = sgi::residual_shape(whole, int64_t(samples.shape(1)), int64_t(samples.shape(0)), max_error);
  const uint16_t *first = samples.data(), *shown = drawn.data();
  require(std::all_of(first, first + samples.size(), [&](uint16_t sample) { return sample <= shape.largest; }),
          "samples must be of the header's type");
  std::vector<uint16_t> found(first, first + samples.size());
  const sgi::Isa isa = sgi::choose_isa("auto");
  sgi::BitRecorder bits;
  {
    const nb::gil_scoped_release release;
    sgi::record_residual(shape, isa, shown, found.data(), bits);
  }
  const uint32_t crc = sgi::crc32({reinterpret_cast<const uint8_t *>(found.data()), 2 * found.size()});
  const std::array count{bits.bits.size()};
  return std::tuple(as_array<int32_t>(std::move(bits.bits), count), as_array<int32_t>(std::move(bits.ones), count),
                    crc);
}

}  // namespace

void bind_residual(nb::module_ &m) {
  m.attr("RESIDUAL_BLOCK") = sgi::kResidualBlock;
  m.def("code_residual", &code_residual, "samples"_a, "drawn"_a, "header"_a, "max_error"_a,
        "Bits of a block [h, w, C] of a residual layer, their P(1) in 2^-16, the CRC-32 of the samples that a reader "
        "finds.");
}
