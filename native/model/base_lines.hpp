// The base layer along rows: every row of its grid interpolated at the columns of a picture.
#pragma once
#include <cstdint>

namespace sgi {

struct BaseGrid {
  const double *values;  // [C, rows, columns]
  int64_t channels, rows, columns;
};

// lines [C, count, width]: row first + i of the grid, at each output column x the sum over t < taps of across[x][t]
// times the cell left[x] + t. Beyond its edges the grid repeats. Each term is added in float64 and the sum rounded to
// float32.
void base_lines(const BaseGrid &grid, int64_t first, int64_t count, const int64_t *left, const double *across,
                int64_t width, int taps, int threads, float *lines);

}  // namespace sgi
