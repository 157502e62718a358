// Bits of a quantised value under a Laplacian or a Gaussian, for V a float or a vector of them.
#pragma once
#include "base/elementary.hpp"
#include "model/constants.hpp"

namespace sgi {
namespace {

// Bits, and their gradients.
template <class V>
struct Bits {
  V bits, deviation, step, scale;
};

// Bits of a probability, and their gradient times `rate`; what is less likely than kMinMass has none.
template <class V>
struct MassBits {
  V bits, slope;

  MassBits(V mass, V rate) {
    const auto live = mass > float(kMinMass);
    const V safe = select(live, mass, V{} + float(kMinMass));
    bits = -log2v(safe);
    slope = select(live, -kLog2e / safe, V{}) * rate;
  }
};

// Of a deviation within a step of width `step` under a Laplacian of standard deviation `scale`. Written with the
// deviation's size so that neither tail cancels.
template <class V>
inline Bits<V> laplace_bits(V deviation, V step, V scale) {
  constexpr float kRoot2 = 1.41421356f;
  const V inverse = 1.0f / scale, rate = kRoot2 * inverse;
  const V half = 0.5f * step, size = absv(deviation);
  const V inside = half - size, beyond = half + size;
  const V near = 0.5f * exp2v(-kLog2e * rate * absv(inside)), far = 0.5f * exp2v(-kLog2e * rate * beyond);
  const V mass = select(inside > 0.0f, 1.0f - near, near) - far;
  const MassBits<V> of(mass, rate);
  return {of.bits, of.slope * (far - near) * signv(deviation), 0.5f * of.slope * (near + far),
          -of.slope * (inside * near + beyond * far) * inverse};
}

// Mass of the normal distribution beyond z, and the density there. Abramowitz and Stegun, 7.1.26 has the form; these
// coefficients are those of Numerical Recipes' erfcc, which are good to 1.2e-7 of the mass itself in the tail.
template <class V>
struct NormalTail {
  V mass, density;

  explicit NormalTail(V z) {
    constexpr float kHalfRoot2 = 0.70710678f, kInverseRoot2Pi = 0.39894228f;
    const V x = absv(z) * kHalfRoot2, t = 1.0f / (1.0f + 0.5f * x);
    V p = V{} + 0.17087277f;
    p = p * t - 0.82215223f;
    p = p * t + 1.48851587f;
    p = p * t - 1.13520398f;
    p = p * t + 0.27886807f;
    p = p * t - 0.18628806f;
    p = p * t + 0.09678418f;
    p = p * t + 0.37409196f;
    p = p * t + 1.00002368f;
    p = p * t - 1.26551223f;
    const V bell = -kLog2e * x * x;
    const V tail = 0.5f * t * exp2v(bell + kLog2e * p);
    mass = select(z < 0.0f, 1.0f - tail, tail);
    density = kInverseRoot2Pi * exp2v(bell);
  }
};

// The same under a Gaussian (paper, equation 10).
template <class V>
inline Bits<V> gaussian_bits(V deviation, V step, V scale) {
  const V inverse = 1.0f / scale, half = 0.5f * step, size = absv(deviation);
  const V low = (size - half) * inverse, high = (size + half) * inverse;
  const NormalTail<V> near(low), far(high);
  const MassBits<V> of(near.mass - far.mass, inverse);
  return {of.bits, of.slope * (far.density - near.density) * signv(deviation),
          0.5f * of.slope * (near.density + far.density), of.slope * (low * near.density - high * far.density)};
}

}  // namespace
}  // namespace sgi
