#include <nanobind/stl/tuple.h>

#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "base/crc32.hpp"
#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/residual_layer.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::bytes_of;
using sgi::require;

namespace {

using Samples = Array<const float, 3>;

// The bytes of a block, the CRC-32 of what a reader finds, information content.
auto code_residual(Samples samples, Samples drawn, nb::bytes header, nb::bytes form, Array<const uint8_t, 1> cells) {
  for (size_t axis = 0; axis < 3; ++axis)
    require(samples.shape(axis) == drawn.shape(axis), "samples and drawn have one shape");
  const sgi::Header whole = sgi::decode_header(bytes_of(header));
  size_t at = 0;
  const sgi::ResidualForm stated = sgi::read_residual_form(whole, bytes_of(form), at);
  require(samples.shape(2) == stated.grids.size() && samples.size() > 0,
          "a block has pixels, of as many channels as the form has");
  const sgi::ResidualBlock block{whole, stated, int64_t(samples.shape(1)), int64_t(samples.shape(0)), drawn.data()};
  require(cells.size() == block.cells(), "a number for each cell of the block");
  sgi::ResidualSamples found{{samples.data(), samples.data() + samples.size()},
                             {cells.data(), cells.data() + cells.size()}};
  const sgi::Isa isa = sgi::choose_isa("auto");
  sgi::RangeEncoder encoder;
  {
    const nb::gil_scoped_release release;
    sgi::encode_residual(block, isa, found, encoder);
  }
  const std::vector<float> &read = found.samples;
  const uint32_t crc = sgi::crc32({reinterpret_cast<const uint8_t *>(read.data()), sizeof(float) * read.size()});
  const double bits = encoder.content();
  return std::tuple(sgi::as_bytes(encoder.finish()), crc, bits);
}

// The bytes of the table of a grid.
auto code_table(bool is_float, double base, double step, int32_t most, Array<const float, 1> table) {
  sgi::ResidualGrid grid{base, step, most, 0, {table.data(), table.data() + table.size()}};
  sgi::RangeEncoder encoder;
  sgi::code_table(encoder, is_float, grid);
  return sgi::as_bytes(encoder.finish());
}

}  // namespace

void bind_residual(nb::module_ &m) {
  m.attr("RESIDUAL_BLOCK") = sgi::kResidualBlock;
  m.attr("RESIDUAL_CELL") = sgi::kResidualCell;
  m.attr("MAX_GRID_STEPS") = sgi::kMaxGridSteps;
  m.attr("MAX_TABLE_STEPS") = sgi::kMaxTableSteps;
  m.attr("MAX_PALETTE") = sgi::kMaxPalette;
  m.def("code_residual", &code_residual, "samples"_a, "drawn"_a, "header"_a, "form"_a, "cells"_a,
        "The bytes of a block [h, w, C] of a residual layer that begins with `form`, the CRC-32 of the samples that a "
        "reader finds, and its information content. cells: 1 for those that are coded, row by row; all where the form "
        "has no cells.");
  m.def("code_table", &code_table, "is_float"_a, "base"_a, "step"_a, "most"_a, "table"_a,
        "The bytes of a table of rising samples [n], floats or those that occur of base + step * (0 ... most).");
}
