// Rows of samples to linear light and to the XYB colours of SSIMULACRA 2, halved rows, and the way back of gradients.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

// Rows are padded (maps.hpp), but for samples; XYB is 0 in the padding.
struct ColourKernel {
  // Linear light of a row of sRGB samples, clipped to 0..1.
  void (*linearize)(const float *samples, int64_t width, float *linear);

  // XYB of a row of linear R, G and B; less another row's, where there is one.
  void (*to_xyb)(const float *const linear[3], const float *const less[3], int64_t width, float *const xyb[3]);

  // Means of 2x2 samples; `below` is null under the last of an odd number of rows, and the last of an odd number of
  // columns has no neighbour.
  void (*halve)(const float *row, const float *below, int64_t width, float *half);

  // The gradient in linear light from that in XYB, where XYB = reference + difference; may be in place.
  void (*to_linear_gradient)(const float *const reference[3], const float *const difference[3],
                             const float *const gradient[3], int64_t width, float *const linear[3]);

  // Adds to a row's gradient its share in that of the half row; `rows` of 1 or 2 are in that.
  void (*add_doubled)(const float *half, int rows, int64_t width, float *gradient);

  // The gradient in sRGB samples from that in linear light; 0 for samples outside 0..1, which are clipped.
  void (*to_sample_gradient)(const float *samples, const float *linear_gradient, int64_t width, float *gradient);

  static const ColourKernel portable, avx2, avx512;
};

}  // namespace sgi
