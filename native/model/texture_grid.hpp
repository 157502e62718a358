// Where the cells of a texture layer lie (docs/format.md, "Grid of texture").
#pragma once

namespace sgi {

constexpr int kTextureGridSteps = 8;  // pixels after which a grid is the same

// Cells lap over their neighbours and begin with the tile, or they are separate, each of its own pixels alone, and the
// first ones begin so many pixels before the tile. What was a JPEG file has its zeros in the latter.
struct TextureGrid {
  bool separate = false;
  int left = 0, top = 0;  // 0 ... kTextureGridSteps - 1, 0 unless separate
};

}  // namespace sgi
