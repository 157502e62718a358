// Where the cells of a texture layer lie (docs/format.md, "Texture").
#pragma once
#include <cstdint>
#include <utility>

namespace sgi {

constexpr int kTextureGridSteps = 8;  // pixels after which a grid is the same

// Cells lap over their neighbours and begin with the tile, or they are separate, each of its own pixels alone, and the
// first ones begin so many pixels before the tile. What was a JPEG file has its zeros in the latter.
struct TextureGrid {
  bool separate = false;
  int left = 0, top = 0;  // 0 ... kTextureGridSteps - 1, 0 unless separate

  // Width and height of the layer of a tile: its pixels, and those before it.
  std::pair<int64_t, int64_t> layer_sides(int64_t width, int64_t height) const { return {width + left, height + top}; }
};

}  // namespace sgi
