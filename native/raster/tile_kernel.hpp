// What one tile needs to be drawn.
#pragma once
#include <cstdint>

#include "base/isa.hpp"
#include "raster/splat.hpp"

namespace sgi {

constexpr int kTileWidth = 64, kTileHeight = 32;  // pixels
constexpr int kTileStride = kTileWidth + 16;      // a vector may begin at any column
constexpr int kTilePlane = kTileHeight * kTileStride;

// One (tile, Gaussian) pair; `slot` is where its partial gradient goes.
struct Entry {
  int32_t gaussian;
  uint32_t slot;
};

// The part of a tile that lies in the view, in view coordinates.
struct TileRect {
  int x, y;                    // first pixel of the tile, view coordinates (may be negative)
  int col0, col1, row0, row1;  // pixels of the tile inside the view
};

// Pixels of a tile are [channels][kTileHeight][kTileStride], of which the first kTileWidth of a row count.
struct TileKernel {
  // Adds the Gaussians of `entries` where they are at least `least` high to a tile whose first pixel is (x0, y0).
  void (*forward)(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                  int y0, float least, float *tile);
  static const TileKernel portable, avx2, avx512;
};

}  // namespace sgi
