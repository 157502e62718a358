// Rows of a separable blur of a bordered plane.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

struct PlaneBlurKernel {
  // Adds the blur of a row to `out`. centre: that row, in a border of at least `reach` rows and columns; down
  // [2 reach + 1]: what the rows from -reach to reach count; across [reach + 1]: what columns count, the centre first;
  // before, after: factors of columns, before and after these are summed; `before` has a border as rows have. scratch:
  // BorderedPlane::stride_of(width) floats.
  void (*add)(const float *centre, int64_t stride, int64_t width, int reach, const float *down, const float *across,
              const float *before, const float *after, float *out, float *scratch);

  static const PlaneBlurKernel portable, avx2, avx512;
};

}  // namespace sgi
