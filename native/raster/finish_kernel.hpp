// From a drawn tile to samples: the background is added, values are clipped, mapped and rounded, channels interleaved.
#pragma once
#include <cstdint>

#include "base/sample.hpp"
#include "raster/tile_kernel.hpp"

namespace sgi {

constexpr int kMaxDrawnChannels = 64;

// What lies behind the Gaussians: row y is the sum over t < taps of down[y][t] * lines[c][top[y] + t], and of `planes`.
struct Background {
  const float *lines;  // [C, count, width]
  int64_t count, width;
  const int32_t *top;   // [height]
  const float *down;    // [height, taps]
  int taps;             // 0 for no lines
  const float *planes;  // [C, height, plane_width], null for none
  int64_t height, plane_width;
};

// Where samples go [height, width, C], and how: sample = low + span * value, of values clipped to 0..1 if `clip`,
// rounded to nearest, ties to even, for integers. Not-a-number becomes 0 if `clip`.
struct Samples {
  void *first;
  int64_t row_stride;  // samples
  SampleType type;
  const float *low, *span;  // [C]
  bool clip;
};

// Every operation is rounded by itself, none fused, so that all instruction sets give the same.
struct FinishKernel {
  // Of a tile.
  void (*finish)(const float *tile, int channels, const TileRect &rect, const Background &background,
                 const Samples &samples);
  // Of values of pixels side by side, their channels in turn: stores samples from the first one on.
  void (*store)(const float *values, int64_t pixels, int channels, const Samples &samples);
  static const FinishKernel portable, avx2, avx512;
};

}  // namespace sgi
