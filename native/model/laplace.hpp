// Bits of a quantised value under a Laplacian, for V a float or a vector of them.
#pragma once
#include "base/scalar.hpp"
#include "model/constants.hpp"

namespace sgi {
namespace {

// Bits, and their gradients.
template <class V>
struct Bits {
  V bits, deviation, step, scale;
};

// Of a deviation within a step of width `step` under a Laplacian of standard deviation `scale`. Written with the
// deviation's size so that neither tail cancels.
template <class V>
inline Bits<V> laplace_bits(V deviation, V step, V scale) {
  constexpr float kLog2e = 1.44269504f, kRoot2 = 1.41421356f;
  const V inverse = 1.0f / scale, rate = kRoot2 * inverse;
  const V half = 0.5f * step, size = absv(deviation);
  const V inside = half - size, beyond = half + size;
  const V near = 0.5f * exp2v(-kLog2e * rate * absv(inside)), far = 0.5f * exp2v(-kLog2e * rate * beyond);
  const V mass = select(inside > 0.0f, 1.0f - near, near) - far;
  const auto live = mass > float(kLeastMass);
  const V safe = select(live, mass, V{} + float(kLeastMass));
  const V slope = select(live, -kLog2e / safe, V{}) * rate;
  return {-log2v(safe), slope * (far - near) * signv(deviation), 0.5f * slope * (near + far),
          -slope * (inside * near + beyond * far) * inverse};
}

}  // namespace
}  // namespace sgi
