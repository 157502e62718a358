// Vectors of LANES floats (compiler vector extensions), for units compiled once per instruction set (isa.hpp).
#pragma once
#include <cstdint>
#include <cstring>

namespace sgi {
namespace {

using vf = float __attribute__((vector_size(LANES * 4)));
using vi = int32_t __attribute__((vector_size(LANES * 4)));

inline vf load(const float *p) {
  vf v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float *p, vf v) { std::memcpy(p, &v, sizeof v); }

inline vf iota() {
  vf v;
  for (int i = 0; i < LANES; ++i) v[i] = static_cast<float>(i);
  return v;
}

// 2^x to about 1e-7 for x <= 126; 0 below -126.
inline vf exp2v(vf x) {
  const vf lo = vf{} - 126.0f, hi = vf{} + 126.0f;
  const vi live = x >= lo;
  x = x > hi ? hi : x;
  const vf magic = vf{} + 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer in the low bits
  const vf t = x + magic;
  const vf f = x - (t - magic);
  vf p = vf{} + 1.3333558e-3f;
  p = p * f + 9.6181291e-3f;
  p = p * f + 5.5504109e-2f;
  p = p * f + 2.4022651e-1f;
  p = p * f + 6.9314718e-1f;
  p = p * f + 1.0f;
  const vi bits = (vi)p + ((vi)t << 23);
  return (vf)(bits & live);
}

}  // namespace
}  // namespace sgi
