// From a drawn tile to samples: the background is added, channels are mixed, values clipped, mapped, rounded and
// interleaved.
#pragma once
#include <cstdint>

#include "base/sample.hpp"
#include "raster/tile_kernel.hpp"

namespace sgi {

constexpr int kMaxDrawnChannels = 64;

// What lies behind the Gaussians of a tile: row y of the view is the sum over t < taps of down[y][t] * lines[c][top[y]
// + t], and of `planes`.
struct Background {
  const float *lines;  // [C, count, width]
  int64_t count, width;
  const int32_t *top;        // [height]
  const float *down;         // [height, taps]
  int taps;                  // 0 for no lines
  const float *planes;       // from the tile's first pixel on, null for none; vectors may be read behind the last one
  int64_t plane, plane_row;  // how far channels and rows are apart there
};

// Where samples go [height, width, C], and how: sample = low + span * value, of values clipped to 0..1 if `clip`,
// rounded to nearest, ties to even, for integers. Not-a-number becomes 0 if `clip`.
struct Samples {
  void *first;
  int64_t row_stride;  // samples
  SampleType type;
  const float *low, *span;  // [C]
  bool clip;
  const float *mix;  // [3, 3]; rows: the first three values each as a mix of channels; null where channels are values
};

// Where channels go as they are [C, height, width].
struct ChannelPlanes {
  float *first;
  int64_t row_stride, plane;
};

// Finishes a tile on its background.
template <class Sink>
using FinishTile = void (*)(const float *tile, int channels, const TileRect &rect, const Background &background,
                            const Sink &sink);

// Every operation is rounded by itself, none fused, so that all instruction sets give the same.
struct FinishKernel {
  FinishTile<Samples> finish;
  FinishTile<ChannelPlanes> finish_channels;
  // Of pixels side by side, from the first sample on: from rows of their channels, and from values, those of a pixel
  // one after the other, which are mixed already.
  void (*store_channels)(const float *const *rows, int64_t pixels, int channels, const Samples &samples);
  void (*store)(const float *values, int64_t pixels, int channels, const Samples &samples);
  static const FinishKernel portable, avx2, avx512;
};

}  // namespace sgi
