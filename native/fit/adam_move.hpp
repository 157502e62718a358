// What one step of Adam does to one number.
#pragma once
#include <cmath>

#include "fit/adam_kernel.hpp"

namespace sgi {
namespace {

inline float multiply_add(float a, float b, float c) {
#if defined(__FMA__) || defined(__CUDACC__)
  return std::fmaf(a, b, c);
#else
  return a * b + c;
#endif
}

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

}  // namespace
}  // namespace sgi
