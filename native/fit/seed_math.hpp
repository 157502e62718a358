// Functions of LANES seeds at once that a step needs beside exp2v: logarithm, noise, bits of a Laplacian, exp of a
// symmetric matrix.
#pragma once
#include "base/vector.hpp"

namespace sgi {
namespace {

using vu = uint32_t __attribute__((vector_size(LANES * 4)));

constexpr float kLn2 = 0.69314718056f;

inline vf select(vi mask, vf yes, vf no) { return (vf)(((vi)yes & mask) | ((vi)no & ~mask)); }
inline vf maxv(vf a, vf b) { return a > b ? a : b; }
inline vf minv(vf a, vf b) { return a < b ? a : b; }
inline vf clampv(vf x, float limit) { return maxv(minv(x, vf{} + limit), vf{} - limit); }
inline vf absv(vf x) { return (vf)((vi)x & 0x7fffffff); }
inline vf signv(vf x) { return select(x > 0.0f, vf{} + 1.0f, select(x < 0.0f, vf{} - 1.0f, vf{})); }

// floor for 0 <= x < 2^22; larger values stay as they are.
inline vf floorv(vf x) {
  const vf magic = vf{} + 8388608.0f;
  const vf near = (x + magic) - magic;
  const vf down = near - select(near > x, vf{} + 1.0f, vf{});
  return select(x < 4194304.0f, down, x);
}

// log2 of a normal positive number, to about 1e-7.
inline vf log2v(vf x) {
  const vi bits = (vi)x;
  vi exponent = (bits >> 23) - 127;
  vf m = (vf)((bits & 0x7fffff) | 0x3f800000);
  const vi big = m > 1.41421356f;
  m = select(big, m * 0.5f, m);
  exponent -= big;  // a mask is -1
  const vf t = (m - 1.0f) / (m + 1.0f), tt = t * t;
  vf p = vf{} + 0.41219859f;  // 2 / (7 ln 2)
  p = p * tt + 0.57707802f;
  p = p * tt + 0.96179669f;
  p = p * tt + 2.88539008f;
  return p * t + __builtin_convertvector(exponent, vf);
}

// Uniform in (-1/2, 1/2), a hash of (key, column, seed): the same whatever the vector's width or the thread. The mixer
// is "lowbias32" of C. Wellons' hash-prospector. `mirror` is 0, or all ones for the negative.
inline vf noise(uint32_t key, uint32_t mirror, uint32_t column, int64_t first_seed) {
  vu x;
  for (int i = 0; i < LANES; ++i) x[i] = static_cast<uint32_t>(first_seed) + i;
  x = x * 0x9e3779b9u ^ (key + column * 0x85ebca6bu);
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  x = x ^ (x >> 16) ^ mirror;
  return __builtin_convertvector((vi)(x >> 8), vf) * 0x1p-24f + (0x1p-25f - 0.5f);
}

// Bits of a deviation within a step of width `step` under a Laplacian of standard deviation `scale`, and gradients.
struct Bits {
  vf bits, deviation, step, scale;
};

inline Bits laplace_bits(vf deviation, vf step, vf scale) {
  constexpr float kFloor = 0x1p-20f, kLog2e = 1.44269504f, kRoot2 = 1.41421356f;
  const vf inverse = 1.0f / scale, rate = kRoot2 * inverse;
  const vf half = 0.5f * step, size = absv(deviation);
  const vf inside = half - size, beyond = half + size;
  const vf near = 0.5f * exp2v(-kLog2e * rate * absv(inside)), far = 0.5f * exp2v(-kLog2e * rate * beyond);
  const vf mass = select(inside > 0.0f, 1.0f - near, near) - far;
  const vi live = mass > kFloor;
  const vf safe = select(live, mass, vf{} + kFloor);
  const vf slope = select(live, -kLog2e / safe, vf{}) * rate;
  return {-log2v(safe), slope * (far - near) * signv(deviation), 0.5f * slope * (near + far),
          -slope * (inside * near + beyond * far) * inverse};
}

// exp(2 M) of M = [[a + b, c], [c, a - b]] is even + [[b, c], [c, -b]] odd: even = e^2a cosh 2r, odd = e^2a sinh(2r) / r
// with r^2 = t = b^2 + c^2. `slope` is d odd / d t; d even / d t is odd.
struct SymmetricExp {
  vf even, odd, slope;
};

inline SymmetricExp symmetric_exp(vf a, vf t) {
  constexpr float kLog2e2 = 2.88539008f;  // 2 log2 e
  const vf scale = exp2v(a * kLog2e2);
  const vf safe = maxv(t, vf{} + 1e-4f);
  const vf r = exp2v(0.5f * log2v(safe));
  const vf grow = exp2v(r * kLog2e2), fall = 1.0f / grow;
  const vf cosh = 0.5f * (grow + fall), sinhc = 0.5f * (grow - fall) / r;
  const vi small = t < 0.02f;  // where differences would cancel: three terms of the series are exact to float32
  const vf even = select(small, 1.0f + t * (2.0f + t * (0.6666667f + t * 0.0888889f)), cosh);
  const vf odd = select(small, 2.0f + t * (1.3333333f + t * (0.2666667f + t * 0.0253968f)), sinhc);
  const vf slope = select(small, 1.3333333f + t * (0.5333333f + t * 0.0761905f), (cosh - 0.5f * sinhc) / safe);
  return {scale * even, scale * odd, scale * slope};
}

}  // namespace
}  // namespace sgi
