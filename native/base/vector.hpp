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

constexpr int kDoubles = LANES / 2;  // in a vector
using vd = double __attribute__((vector_size(kDoubles * 8)));

inline vd load(const double *p) {
  vd v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(double *p, vd v) { std::memcpy(p, &v, sizeof v); }

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

inline vu bits_of(vf x) { return (vu)x; }
inline vf float_of(vu bits) { return (vf)bits; }

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
