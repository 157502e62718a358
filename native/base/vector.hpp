// Vectors of LANES floats (compiler vector extensions), for units compiled once per instruction set (isa.hpp). A vector
// of one lane is a number: what is written for vectors runs on a GPU, where a thread is a lane.
#pragma once
#include <cstdint>
#include <cstring>

#include "base/scalar.hpp"

namespace sgi {
namespace {

#if LANES == 1

using vf = float;
using vi = int32_t;
using vu = uint32_t;

inline vf load(const float *p) { return *p; }
inline void store(float *p, vf v) { *p = v; }
inline float lane(vf v, int) { return v; }
template <class V, class T>
inline void set_lane(V &v, int, T value) {
  v = value;
}
inline vf to_floats(vi v) { return float(v); }

#else

using vf = float __attribute__((vector_size(LANES * 4)));
using vi = int32_t __attribute__((vector_size(LANES * 4)));
using vu = uint32_t __attribute__((vector_size(LANES * 4)));

inline vf load(const float *p) {
  vf v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float *p, vf v) { std::memcpy(p, &v, sizeof v); }
inline float lane(vf v, int i) { return v[i]; }
template <class V, class T>
inline void set_lane(V &v, int i, T value) {
  v[i] = value;
}
inline vf to_floats(vi v) { return __builtin_convertvector(v, vf); }

inline vf iota() {
  vf v;
  for (int i = 0; i < LANES; ++i) v[i] = static_cast<float>(i);
  return v;
}

// 2^x to 2.3e-7 of itself for x <= 126, exact for whole numbers; 0 below -126. The polynomial has the least greatest
// error of its degree, 7e-8; the rest is rounding.
inline vf exp2v(vf x) {
  const vf lo = vf{} - 126.0f, hi = vf{} + 126.0f;
  const vi live = x >= lo;
  x = x > hi ? hi : x;
  const vf magic = vf{} + 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer in the low bits
  const vf t = x + magic;
  const vf f = x - (t - magic);
  vf p = vf{} + 1.32028596e-3f;
  p = p * f + 9.67495330e-3f;
  p = p * f + 5.55104762e-2f;
  p = p * f + 2.40221664e-1f;
  p = p * f + 6.93146586e-1f;
  p = p * f + 1.0f;
  const vu bits = (vu)p + ((vu)t << 23);  // wraps in lanes that are not live
  return (vf)(bits & (vu)live);
}

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

// x^(-1/3) of a normal positive number, to 2.5e-7 of itself.
inline vf inverse_cube_root(vf x) {
  // The bits of a float are about its logarithm.
  const vf guess = to_floats((vi)x) * (-1.0f / 3.0f) + 1.4199e9f;
  vf y = (vf) __builtin_convertvector(guess, vi);
  const vf third = x * (1.0f / 3.0f);
  for (int i = 0; i < 3; ++i) y *= 4.0f / 3.0f - third * (y * y * y);
  return y;
}

// Sine and cosine to about 1e-7 for |x| < 2^13: a quarter turn is taken off in three parts, and polynomials of the
// least greatest error do the rest.
inline void sine_cosine(vf x, vf &sine, vf &cosine) {
  const vf magic = vf{} + 12582912.0f;
  const vf t = x * 0.63661977f + magic, turns = t - magic;
  const vi quarter = (vi)t;
  const vf r = ((x - turns * 1.5703125f) - turns * 4.8375129699707031e-4f) - turns * 7.549789948768648e-8f;
  const vf rr = r * r;
  vf s = vf{} - 1.9515295891e-4f;
  s = s * rr + 8.3321608736e-3f;
  s = s * rr - 1.6666654611e-1f;
  s = s * rr * r + r;
  vf c = vf{} + 2.443315711809948e-5f;
  c = c * rr - 1.388731625493765e-3f;
  c = c * rr + 4.166664568298827e-2f;
  c = c * rr * rr - 0.5f * rr + 1.0f;
  const vi swaps = (quarter & 1) != 0, negative_sine = (quarter & 2) << 30, negative_cosine = ((quarter + 1) & 2) << 30;
  sine = (vf)((vi)select(swaps, c, s) ^ negative_sine);
  cosine = (vf)((vi)select(swaps, s, c) ^ negative_cosine);
}

// Square root. A loop of its own is what compilers make one instruction of.
inline vf rootv(vf x) {
  float lanes[LANES];
  store(lanes, x);
  for (float &lane : lanes) lane = __builtin_sqrtf(lane);
  return load(lanes);
}

#endif

}  // namespace
}  // namespace sgi
