// The operations, their order and which of them are fused are those of torch's fused Adam, so that equal gradients give
// equal numbers: CMake keeps the compiler from fusing others in this file.
#include "fit/adam_kernel.hpp"

namespace sgi {
namespace {

inline float multiply_add(float a, float b, float c) {
#ifdef __FMA__
  return __builtin_fmaf(a, b, c);
#else
  return a * b + c;
#endif
}

void move_run(const AdamStep &step, const float *__restrict gradient, int64_t n, float *__restrict value,
              float *__restrict mean, float *__restrict square) {
  const float weight = float(1.0 - step.beta1), beta2 = float(step.beta2), weight2 = float(1.0 - step.beta2);
  const float rate = float(-step.rate), root = float(step.root_correction), epsilon = float(step.epsilon);
  for (int64_t i = 0; i < n; ++i) {
    const float g = gradient[i];
    const float m = multiply_add(weight, g - mean[i], mean[i]);
    const float s = multiply_add(weight2 * g, g, square[i] * beta2);
    mean[i] = m;
    square[i] = s;
    value[i] += rate * m / (__builtin_sqrtf(s) / root + epsilon);
  }
}

}  // namespace

const AdamKernel AdamKernel::SGI_ISA{&move_run};

}  // namespace sgi
