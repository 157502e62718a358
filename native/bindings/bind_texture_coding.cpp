#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bindings/textures.hpp"
#include "bindings/tile_models.hpp"
#include "bitstream/texture_cells.hpp"
#include "bitstream/texture_stream.hpp"
#include "rdoq/texture_colour_search.hpp"
#include "rdoq/texture_search.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::BitModels;
using sgi::has_shape;
using sgi::require;
using sgi::TextureField;

namespace {

using Size = std::pair<int64_t, int64_t>;
using LogSizes = Array<const uint8_t, 2>;
using Contrasts = Array<const int8_t, 2>;
using SymbolPlanes = Array<const int16_t, 3>;

void require_size(Size size, size_t channels) {
  require(size.first > 0 && size.second > 0 && size.first < (1 << 30) && size.second < (1 << 30), "a tile has pixels");
  require(channels >= 1 && channels <= 64, "1 to 64 channels");
}

// A leaf fills its place in the quadtree.
void require_tree(const TextureField &field) {
  for (int64_t y = 0; y < field.height; y += sgi::kUnit)
    for (int64_t x = 0; x < field.width; x += sgi::kUnit) {
      const int log = field.log_size[field.unit(x, y)];
      require(log == 0 || (log >= sgi::kTextureLeast && log <= sgi::kTextureRoot), "log_size must be 0, 3, 4 or 5");
      if (!log) continue;
      const int64_t side = int64_t(1) << log, left = x & ~(side - 1), top = y & ~(side - 1);
      require(field.log_size[field.unit(left, top)] == log &&
                  (x == left || field.log_size[field.unit(x - 8, y)] == log) &&
                  (y == top || field.log_size[field.unit(x, y - 8)] == log),
              "cells must fill their places");
    }
}

}  // namespace

TextureField sgi::field_of(const LogSizes &log_size, const Contrasts &contrast, const SymbolPlanes &symbols) {
  const int64_t down = int64_t(contrast.shape(0)), across = int64_t(contrast.shape(1));
  require(has_shape(log_size, size_t(down * 4), size_t(across * 4)) && symbols.shape(1) == size_t(down * 32) &&
              symbols.shape(2) == size_t(across * 32) && symbols.shape(0) >= 1 && symbols.shape(0) <= 64,
          "contrast [h, w] of roots, log_size [4 h, 4 w], symbols [C, 32 h, 32 w]");
  TextureField field(across, down, int(symbols.shape(0)));
  std::copy_n(log_size.data(), log_size.size(), field.log_size.begin());
  std::copy_n(contrast.data(), contrast.size(), field.contrast.begin());
  std::copy_n(symbols.data(), symbols.size(), field.symbols.begin());
  require_tree(field);
  for (const int8_t index : field.contrast)
    require(std::abs(int(index)) <= sgi::kContrastLimit, "contrasts must be -15..15");
  return field;
}

sgi::TextureGrid sgi::grid_of(TextureGridFields given) {
  const auto [separate, left, top] = given;
  require(left >= 0 && top >= 0 && left < sgi::kTextureGridSteps && top < sgi::kTextureGridSteps &&
              (separate || (left == 0 && top == 0)),
          "a grid begins 0 to 7 pixels before the tile, with it where cells lap over");
  return {separate, left, top};
}

namespace {

// Steps that suit the amplitudes, as the contrasts must.
sgi::TextureSteps steps_of(nb::handle steps, const sgi::TextureAmplitudes &amplitudes, Contrasts contrast) {
  const auto down = size_t(amplitudes.height >> sgi::kTextureRoot);
  const auto across = size_t(amplitudes.width >> sgi::kTextureRoot);
  require(has_shape(contrast, down, across), "contrast [h, w] of the roots");
  for (size_t i = 0; i < contrast.size(); ++i)
    require(std::abs(int(contrast.data()[i])) <= sgi::kContrastLimit, "contrasts must be -15..15");
  return sgi::indices_of(steps, size_t(amplitudes.channels)).steps();
}

// Cells of a layer that suit the amplitudes, null for none given.
const uint8_t *require_division(const sgi::TextureAmplitudes &amplitudes, const std::optional<LogSizes> &division) {
  if (!division) return nullptr;
  const int64_t across = amplitudes.width >> sgi::kTextureRoot, down = amplitudes.height >> sgi::kTextureRoot;
  require(has_shape(*division, size_t(4 * down), size_t(4 * across)), "division [4 h, 4 w] of the roots");
  TextureField field(across, down, 1);
  std::copy_n(division->data(), division->size(), field.log_size.begin());
  require_tree(field);
  return division->data();
}

// The width and height of a layer's tile.
Size size_of(nb::handle layer) { return nb::cast<Size>(layer.attr("size")); }

void learn(BitModels &models, nb::handle layer) {
  const sgi::CodedTexture texture = sgi::texture_of(layer);
  const auto [width, height] = size_of(layer);
  const Size sides = texture.indices.grid.layer_sides(width, height);
  sgi::BitTaker nowhere;
  sgi::write_texture(models, nowhere, texture.field, sides.first, sides.second, texture.indices.has_contrast);
}

auto search_texture(const sgi::TextureAmplitudes &amplitudes, Contrasts contrast, nb::handle steps, float lmbda,
                    float split_margin, std::optional<LogSizes> division) {
  require(lmbda >= 0, "lmbda must not be negative");
  require(split_margin >= 1, "split_margin must be at least 1");
  const uint8_t *const cells = require_division(amplitudes, division);
  const sgi::TextureSteps all = steps_of(steps, amplitudes, contrast);
  const bool has_contrast = nb::cast<bool>(steps.attr("has_contrast"));
  sgi::TextureFound found = [&] {
    nb::gil_scoped_release release;
    return sgi::search_texture(sgi::shipped_texture_models(), amplitudes, contrast.data(), all,
                               {lmbda, has_contrast, split_margin}, cells);
  }();
  return std::tuple(sgi::field_arrays(std::move(found.field)), found.count, found.excess);
}

void require_planes(Array<const float, 3> planes, Size size) {
  require_size(size, planes.shape(0));
  require(planes.shape(1) == size_t(sgi::texture_roots(size.second) * 32) &&
              planes.shape(2) == size_t(sgi::texture_roots(size.first) * 32),
          "planes [C, 32 h, 32 w] of the roots");
}

using Colours = std::array<int, 3>;

sgi::TextureColours colours_of(Colours indices, size_t channels) {
  const sgi::TextureColours colours{{indices[0], indices[1]}, indices[2]};
  require(colours.same() || channels >= 3, "colours are of three channels or more");
  return colours;
}

void make_amplitudes(sgi::TextureAmplitudes *self, Array<const float, 3> planes, Size size, int threads,
                     Colours colours, bool separate) {
  require_planes(planes, size);
  const sgi::TextureColours mixed = colours_of(colours, planes.shape(0));
  nb::gil_scoped_release release;
  const sgi::TextureLayout layout{size.first, size.second, separate};
  new (self) sgi::TextureAmplitudes(planes.data(), int(planes.shape(0)), layout, threads, mixed);
}

auto cheapest_colours(Array<const float, 3> planes, Contrasts contrast, nb::handle steps, float lmbda, bool separate,
                      int threads) {
  const size_t down = contrast.shape(0), across = contrast.shape(1);
  require(down && across && planes.shape(1) == 32 * down && planes.shape(2) == 32 * across && planes.shape(0) >= 3,
          "contrast [h, w] of the roots, planes [C, 32 h, 32 w], three or more");
  const sgi::TextureSteps all = sgi::indices_of(steps, planes.shape(0)).steps();
  nb::gil_scoped_release release;
  const sgi::TextureColours found = sgi::cheapest_colours(planes.data(), int64_t(32 * across), int64_t(32 * down),
                                                          contrast.data(), all, lmbda, separate, threads);
  return std::tuple(found.shares[0], found.shares[1], found.turn);
}

void move_amplitudes(sgi::TextureAmplitudes &amplitudes, Array<const float, 3> gradient, Contrasts contrast,
                     nb::handle steps, float mean, float most, std::optional<LogSizes> division) {
  require_planes(gradient, {amplitudes.layout.width, amplitudes.layout.height});
  require(int(gradient.shape(0)) == amplitudes.channels, "a gradient of as many channels");
  const uint8_t *const cells = require_division(amplitudes, division);
  const sgi::TextureSteps all = steps_of(steps, amplitudes, contrast);
  nb::gil_scoped_release release;
  amplitudes.move(gradient.data(), contrast.data(), all, mean, most, cells);
}

double estimate_texture(const sgi::TextureAmplitudes &amplitudes, Contrasts contrast, nb::handle steps, float lmbda) {
  require(lmbda >= 0, "lmbda must not be negative");
  const sgi::TextureSteps all = steps_of(steps, amplitudes, contrast);
  const bool has_contrast = nb::cast<bool>(steps.attr("has_contrast"));
  const nb::gil_scoped_release release;
  return sgi::estimate_texture(amplitudes, contrast.data(), all, {lmbda, has_contrast, 1});
}

auto draw_texture(nb::handle layer, int threads, const std::string &isa) {
  sgi::CodedTexture texture = sgi::texture_of(layer);
  const auto [width, height] = size_of(layer);
  const sgi::TextureIndices &indices = texture.indices;
  const int channels = texture.field.channels;
  const std::array shape{size_t(channels), size_t(height), size_t(width)};
  std::vector<float> planes(shape[0] * shape[1] * shape[2]);
  {
    const nb::gil_scoped_release release;
    texture.field.find_extents();
    sgi::TextureCells cells;
    cells.reserve(texture.field);
    sgi::TextureDequantizer dequantizer(indices.steps(), indices.added(), indices.colours, cells);
    sgi::read_cells(texture.field, dequantizer);
    sgi::draw_texture(cells.texture(channels, width, height, indices.grid), {0, 1, 0, width}, {0, 1, 0, height},
                      threads, sgi::choose_isa(isa), planes.data());
  }
  return as_array<float>(std::move(planes), shape);
}

}  // namespace

void bind_texture_coding(nb::module_ &m) {
  nb::class_<BitModels>(m, "TextureModels", "Adaptive models, which say nothing yet.")
      .def("__init__", [](BitModels *self) { new (self) BitModels(sgi::fresh_texture_models()); })
      .def(
          "logits", [](const BitModels &self) { return as_array(self.logits()); }, "What each context says, in 2^-16.")
      .def("learn", &learn, "layer"_a, "A TextureSymbols.");
  nb::class_<sgi::TextureAmplitudes>(m, "TextureAmplitudes")
      .def("__init__", &make_amplitudes, "planes"_a, "size"_a, "threads"_a, "colours"_a, "separate"_a,
           "planes [C, 32 h, 32 w]; size: of the layer, its pixels before the tile included.")
      .def("search", &search_texture, "contrast"_a, "steps"_a, "lmbda"_a, "split_margin"_a, "division"_a.none(),
           "log_size, contrast and symbols; by magnitude 1, 2 and more the symbols and the sum of their excess. steps: "
           "TextureIndices.")
      .def("estimate", &estimate_texture, "contrast"_a, "steps"_a, "lmbda"_a,
           "Squared error plus lmbda times bits, in squared steps, of the best layer, about.")
      .def("move", &move_amplitudes, "gradient"_a, "contrast"_a, "steps"_a, "mean"_a, "most"_a, "division"_a.none(),
           "Moves them up a gradient, [C, 32 h, 32 w] of the roots, in the mean by `mean` of a step, at most by "
           "`most`; with log2 of the sides of a layer's cells [4 h, 4 w], those alone.");
  m.def("draw_texture", &draw_texture, "layer"_a, "threads"_a, "isa"_a,
        "Planes [C, h, w] of the tile of a TextureSymbols.");
  m.def("cheapest_colours", &cheapest_colours, "planes"_a, "contrast"_a, "steps"_a, "lmbda"_a, "separate"_a,
        "threads"_a, "Indices of the colours in which texture that shows these planes costs least, about.");
}
