// What one tile needs to be compared and differentiated.
#pragma once
#include "raster/tile_kernel.hpp"

namespace sgi {

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

// What only a fit computes: products may be fused with sums.
struct GradientKernel {
  // As `TileKernel::forward`, in the last bits not what decoders draw, but faster.
  decltype(TileKernel::forward) forward;
  // Turns a drawn tile into the loss's gradient within the view, 0 elsewhere and where nothing differs. width, height:
  // of the view.
  Errors (*compare)(float *tile, int channels, const TileRect &rect, const Comparison &with, int64_t width,
                    int64_t height);
  // Writes partials[slot][kMoments + channels] of every entry, from dL/dI = grad; beyond kTileWidth that must be 0. A
  // little of what lies below the least height counts, too.
  void (*backward)(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                   int y0, const float *grad, float *partials);
  static const GradientKernel portable, avx2, avx512;
};

}  // namespace sgi
