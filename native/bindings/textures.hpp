// Layers of texture as Python has them.
#pragma once
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <tuple>
#include <utility>

#include "bindings/arrays.hpp"
#include "bitstream/texture_part.hpp"

namespace sgi {

// A layer from its arrays, whose cells fill their places. Raises ValueError.
TextureField field_of(const Array<const uint8_t, 2> &log_size, const Array<const int8_t, 2> &contrast,
                      const Array<const int16_t, 3> &symbols);

// Whether cells are separate, and the pixels of the first ones that lie before the tile.
using TextureGridFields = std::tuple<bool, int, int>;
TextureGrid grid_of(TextureGridFields given);

// log_size, contrast and symbols of a layer.
inline auto field_arrays(TextureField field) {
  const auto down = size_t(field.height), across = size_t(field.width), channels = size_t(field.channels);
  return std::tuple(
      as_array<uint8_t>(std::move(field.log_size), std::array{down / kUnit, across / kUnit}),
      as_array<int8_t>(std::move(field.contrast), std::array{down >> kTextureRoot, across >> kTextureRoot}),
      as_array<int16_t>(std::move(field.symbols), std::array{channels, down, across}));
}

// Its steps as indices of the stream, in the order of TextureIndices in Python, its grid as TextureGrid, and these.
inline auto texture_arrays(const TextureIndices &of, TextureField field) {
  const auto [one, two, more] = of.excess;
  std::tuple steps(of.step, of.ratios, std::pair(of.slopes[0], of.slopes[1]), std::tuple(one, two, more),
                   of.has_contrast, std::tuple(of.colours.shares[0], of.colours.shares[1], of.colours.turn),
                   std::tuple(of.grid.separate, of.grid.left, of.grid.top));
  return std::tuple_cat(std::tuple<decltype(steps)>(std::move(steps)), field_arrays(std::move(field)));
}

}  // namespace sgi
