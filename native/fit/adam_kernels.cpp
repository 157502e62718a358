// The operations, their order and which of them are fused are those of torch's fused Adam, so that equal gradients give
// equal numbers: CMake keeps the compiler from fusing others in this file.
#include <cmath>

#include "fit/adam_kernel.hpp"

namespace sgi {
namespace {

inline float multiply_add(float a, float b, float c) {
#if defined(__FMA__)
  return std::fmaf(a, b, c);
#else
  return a * b + c;
#endif
}

// What a step does to one number.
struct AdamMove {
  float weight, beta2, weight2, rate, root, epsilon;

  explicit AdamMove(const AdamStep &step)
      : weight(float(1.0 - step.beta1)), beta2(float(step.beta2)), weight2(float(1.0 - step.beta2)),
        rate(float(-step.rate)), root(float(step.root_correction)), epsilon(float(step.epsilon)) {}

  void operator()(float gradient, float &value, float &mean, float &square) const {
    const float m = multiply_add(weight, gradient - mean, mean);
    const float s = multiply_add(weight2 * gradient, gradient, square * beta2);
    mean = m;
    square = s;
    value += rate * m / (std::sqrt(s) / root + epsilon);
  }
};

void move_run(const AdamStep &step, const float *__restrict gradient, int64_t n, float *__restrict value,
              float *__restrict mean, float *__restrict square) {
  const AdamMove move(step);
  for (int64_t i = 0; i < n; ++i) move(gradient[i], value[i], mean[i], square[i]);
}

}  // namespace

const AdamKernel AdamKernel::SGI_ISA{&move_run};

}  // namespace sgi
