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

void require_field(const TextureField &field, Size size) {
  require(field.width == sgi::texture_roots(size.first) * 32 && field.height == sgi::texture_roots(size.second) * 32,
          "the layer must have the roots of the tile");
}

sgi::TextureSteps steps_of(const Array<const float, 1> &steps, std::pair<float, float> slope) {
  for (size_t i = 0; i < steps.size(); ++i) require(steps.data()[i] > 0, "steps must be positive");
  require(slope.first >= 0 && slope.second >= 0, "slopes must not be negative");
  return {{steps.data(), steps.data() + steps.size()}, {slope.first, slope.second}};
}

void require_contrasts(const sgi::TextureAmplitudes &amplitudes, Contrasts contrast, Array<const float, 1> steps) {
  const auto down = size_t(amplitudes.height >> sgi::kTextureRoot);
  const auto across = size_t(amplitudes.width >> sgi::kTextureRoot);
  require(has_shape(contrast, down, across) && steps.size() == size_t(amplitudes.channels),
          "contrast [h, w] of the roots, steps [C]");
  for (size_t i = 0; i < contrast.size(); ++i)
    require(std::abs(int(contrast.data()[i])) <= sgi::kContrastLimit, "contrasts must be -15..15");
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

class TextureModels {
 public:
  TextureModels() : models_(sgi::fresh_texture_models()) {}
  explicit TextureModels(BitModels models) : models_(std::move(models)) {}
  explicit TextureModels(nb::bytes state) : TextureModels() {
    require(models_.start(sgi::bytes_of(state)), "these are not texture models");
  }

  auto logits() const { return as_array(models_.logits()); }

  void learn(LogSizes log_size, Contrasts contrast, SymbolPlanes symbols, Size size, bool has_contrast) {
    const TextureField field = sgi::field_of(log_size, contrast, symbols);
    require_field(field, size);
    sgi::BitTaker nowhere;
    sgi::write_texture(models_, nowhere, field, size.first, size.second, has_contrast);
  }

  auto search(const sgi::TextureAmplitudes &amplitudes, Contrasts contrast, Array<const float, 1> steps,
              std::pair<float, float> slope, float lmbda, bool has_contrast, float split_margin,
              std::optional<LogSizes> division) const {
    require_contrasts(amplitudes, contrast, steps);
    require(lmbda >= 0, "lmbda must not be negative");
    require(split_margin >= 1, "split_margin must be at least 1");
    const uint8_t *const cells = require_division(amplitudes, division);
    const sgi::TextureSteps all = steps_of(steps, slope);
    sgi::TextureFound found = [&] {
      nb::gil_scoped_release release;
      return sgi::search_texture(models_, amplitudes, contrast.data(), all, {lmbda, has_contrast, split_margin}, cells);
    }();
    return std::tuple(sgi::field_arrays(std::move(found.field)), found.count, found.excess);
  }

 private:
  BitModels models_;
};

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

auto cheapest_colours(Array<const float, 3> planes, Contrasts contrast, Array<const float, 1> steps,
                      std::pair<float, float> slope, float lmbda, bool separate, int threads) {
  const size_t down = contrast.shape(0), across = contrast.shape(1);
  require(down && across && planes.shape(1) == 32 * down && planes.shape(2) == 32 * across,
          "contrast [h, w] of the roots, planes [C, 32 h, 32 w]");
  require(planes.shape(0) >= 3 && steps.size() == planes.shape(0), "three channels or more, steps [C]");
  const sgi::TextureSteps all = steps_of(steps, slope);
  nb::gil_scoped_release release;
  const sgi::TextureColours found = sgi::cheapest_colours(planes.data(), int64_t(32 * across), int64_t(32 * down),
                                                          contrast.data(), all, lmbda, separate, threads);
  return std::tuple(found.shares[0], found.shares[1], found.turn);
}

void move_amplitudes(sgi::TextureAmplitudes &amplitudes, Array<const float, 3> gradient, Contrasts contrast,
                     Array<const float, 1> steps, std::pair<float, float> slope, float mean, float most,
                     std::optional<LogSizes> division) {
  require_planes(gradient, {amplitudes.layout.width, amplitudes.layout.height});
  require(int(gradient.shape(0)) == amplitudes.channels, "a gradient of as many channels");
  require_contrasts(amplitudes, contrast, steps);
  const uint8_t *const cells = require_division(amplitudes, division);
  const sgi::TextureSteps all = steps_of(steps, slope);
  nb::gil_scoped_release release;
  amplitudes.move(gradient.data(), contrast.data(), all, mean, most, cells);
}

double estimate_texture(const sgi::TextureAmplitudes &amplitudes, Contrasts contrast, Array<const float, 1> steps,
                        std::pair<float, float> slope, float lmbda, bool has_contrast) {
  require_contrasts(amplitudes, contrast, steps);
  require(lmbda >= 0, "lmbda must not be negative");
  const sgi::TextureSteps all = steps_of(steps, slope);
  const nb::gil_scoped_release release;
  return sgi::estimate_texture(amplitudes, contrast.data(), all, {lmbda, has_contrast, 1});
}

void draw_texture(LogSizes log_size, Contrasts contrast, SymbolPlanes symbols, Array<const float, 1> steps,
                  std::pair<float, float> slope, std::array<float, 3> excess, Colours colours,
                  sgi::TextureGridFields indices, int threads, const std::string &isa, Array<float, 3> planes) {
  const size_t channels = symbols.shape(0);
  require(steps.size() == channels && planes.shape(0) == channels, "steps [C], planes [C, h, w]");
  const int64_t height = int64_t(planes.shape(1)), width = int64_t(planes.shape(2));
  require_size({width, height}, channels);
  const sgi::TextureColours mixed = colours_of(colours, channels);
  const sgi::TextureSteps all = steps_of(steps, slope);
  const sgi::TextureGrid grid = sgi::grid_of(indices);
  TextureField field = sgi::field_of(log_size, contrast, symbols);
  require_field(field, grid.layer_sides(width, height));
  const nb::gil_scoped_release release;
  field.find_extents();
  sgi::TextureCells cells;
  cells.reserve(field);
  sgi::TextureDequantizer dequantizer(all, excess, mixed, cells);
  sgi::read_cells(field, dequantizer);
  sgi::draw_texture(cells.texture(int(channels), width, height, grid), {0, 1, 0, width}, {0, 1, 0, height}, threads,
                    sgi::choose_isa(isa), planes.data());
}

}  // namespace

void bind_texture_coding(nb::module_ &m) {
  nb::class_<TextureModels>(m, "TextureModels")
      .def(nb::init<>())
      .def(nb::init<nb::bytes>(), "state"_a)
      .def_static(
          "shipped", [] { return TextureModels(sgi::shipped_texture_models()); },
          "Those with which every layer begins.")
      .def("logits", &TextureModels::logits, "What each context says, in 2^-16.")
      .def("learn", &TextureModels::learn, "log_size"_a, "contrast"_a, "symbols"_a, "size"_a, "has_contrast"_a)
      .def("search", &TextureModels::search, "amplitudes"_a, "contrast"_a, "steps"_a, "slope"_a, "lmbda"_a,
           "has_contrast"_a, "split_margin"_a, "division"_a.none(),
           "log_size, contrast and symbols; by magnitude 1, 2 and more the symbols and the sum of their excess.");
  nb::class_<sgi::TextureAmplitudes>(m, "TextureAmplitudes")
      .def("__init__", &make_amplitudes, "planes"_a, "size"_a, "threads"_a, "colours"_a, "separate"_a,
           "planes [C, 32 h, 32 w]; size: of the layer, its pixels before the tile included.")
      .def("estimate", &estimate_texture, "contrast"_a, "steps"_a, "slope"_a, "lmbda"_a, "has_contrast"_a,
           "Squared error plus lmbda times bits, in squared steps, of the best layer, about.")
      .def("move", &move_amplitudes, "gradient"_a, "contrast"_a, "steps"_a, "slope"_a, "mean"_a, "most"_a,
           "division"_a = nb::none(),
           "Moves them up a gradient, [C, 32 h, 32 w] of the roots, in the mean by `mean` of a step, at most by "
           "`most`; with log2 of the sides of a layer's cells [4 h, 4 w], those alone.");
  m.def("draw_texture", &draw_texture, "log_size"_a, "contrast"_a, "symbols"_a, "steps"_a, "slope"_a, "excess"_a,
        "colours"_a, "grid"_a, "threads"_a, "isa"_a, "planes"_a, "Draws a layer into planes [C, h, w] of its tile.");
  m.def("cheapest_colours", &cheapest_colours, "planes"_a, "contrast"_a, "steps"_a, "slope"_a, "lmbda"_a, "separate"_a,
        "threads"_a, "Indices of the colours in which texture that shows these planes costs least, about.");
}
