// The base layer at any place and any scale, pixel by pixel the same whichever part of the picture is rendered.
#pragma once
#include <cstdint>
#include <vector>

#include "model/output_axis.hpp"

namespace sgi {

struct BaseGrid {
  const double *values;  // [C, rows, columns]
  int64_t channels, rows, columns;
};

// Row i of a block is the sum over t < taps of down[i][t] times line top[i] + t.
struct BaseView {
  std::vector<float> lines;  // [C, count, width]
  std::vector<int32_t> top;  // [height]
  std::vector<float> down;   // [height, taps]
  int64_t count;
  int taps;
};

// The base layer at the pixels of both axes, of cells of `cell` pixels: each is its mean over the pixel, by one sample
// at its centre where it is small.
BaseView base_view(const BaseGrid &grid, int cell, const OutputAxis &x, const OutputAxis &y, int threads);

}  // namespace sgi
