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

// Sums over pixels and channels of weight * (I - target)^2 and of (I - target)^2.
struct SquaredErrors {
  double weighted, plain;
};

// Sums over pixels and channels of |I - target| and of (I - target)^2.
struct AbsoluteErrors {
  double absolute, squared;
};

// Pixels of a tile are [channels][kTileHeight][kTileStride], of which the first kTileWidth of a row count.
struct TileKernel {
  // Adds the Gaussians of `entries` to a tile whose first pixel is (x0, y0).
  void (*forward)(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                  int y0, float *tile);
  // Turns a drawn tile into the gradient 2 weight (I - target) within the view, 0 elsewhere; returns the sum of
  // (I - target)^2. target [channels, height, width] of the view.
  double (*compare)(float *tile, int channels, const TileRect &rect, const float *target, int64_t width, int64_t height,
                    float weight);
  // The same with the gradient 2 weights (I - target), weights [height, width] of the view; returns both sums.
  SquaredErrors (*compare_weighted)(float *tile, int channels, const TileRect &rect, const float *target,
                                    const float *weights, int64_t width, int64_t height);
  // The same with the gradient weight sign(I - target), sign(0) = 0; returns both sums, without the weight.
  AbsoluteErrors (*compare_absolute)(float *tile, int channels, const TileRect &rect, const float *target,
                                     int64_t width, int64_t height, float weight);
  // Writes partials[slot][kMoments + channels] of every entry, from dL/dI = grad; beyond kTileWidth that must be 0.
  void (*backward)(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                   int y0, const float *grad, float *partials);
  static const TileKernel portable, avx2, avx512;
};

}  // namespace sgi
