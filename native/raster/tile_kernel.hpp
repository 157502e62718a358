// What one tile needs to be drawn and differentiated.
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

// What a drawn picture I is compared by: the squares of its errors, or their sizes.
enum class Loss : int { kSquared, kAbsolute };

// What it is compared with: target [channels, height, width] of the view, and weights [height, width] of its pixels,
// null where all are 1. The loss is the sum over pixels and channels of weight * weights * (I - target)^2 or |I -
// target|.
struct Comparison {
  Loss loss;
  const float *target, *weights;
  float weight;
};

// The loss without `weight`, and the sum of (I - target)^2.
struct Errors {
  double loss, squared;
};

// Pixels of a tile are [channels][kTileHeight][kTileStride], of which the first kTileWidth of a row count.
struct TileKernel {
  // Adds the Gaussians of `entries` to a tile whose first pixel is (x0, y0).
  void (*forward)(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                  int y0, float *tile);
  // Turns a drawn tile into the loss's gradient within the view, 0 elsewhere and where nothing differs. width, height:
  // of the view.
  Errors (*compare)(float *tile, int channels, const TileRect &rect, const Comparison &with, int64_t width,
                    int64_t height);
  // Writes partials[slot][kMoments + channels] of every entry, from dL/dI = grad; beyond kTileWidth that must be 0.
  void (*backward)(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                   int y0, const float *grad, float *partials);
  static const TileKernel portable, avx2, avx512;
};

}  // namespace sgi
