// One step of Adam on a run of numbers.
#pragma once
#include <cstdint>

namespace sgi {

// What a step's arithmetic depends on beside the numbers: decay rates of the two moments, the learning rate over the
// first moment's bias correction, the root of the second's.
struct AdamStep {
  double beta1, beta2, rate, root_correction, epsilon;
};

struct AdamKernel {
  void (*move)(const AdamStep &step, const float *gradient, int64_t n, float *value, float *mean, float *square);
  static const AdamKernel portable, avx2, avx512;
};

}  // namespace sgi
