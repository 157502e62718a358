// Functions of numbers under the names that vector.hpp gives them for vectors: what is written once for both takes
// either. On a GPU, too.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

namespace sgi {
namespace {

constexpr float kLog2e = 1.44269504f;

#ifdef __CUDACC_RTC__  // has no std::memcpy
inline uint32_t bits_of(float x) { return __float_as_uint(x); }
inline float float_of(uint32_t bits) { return __uint_as_float(bits); }
#else
inline uint32_t bits_of(float x) {
  uint32_t bits;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
inline float float_of(uint32_t bits) {
  float x;
  std::memcpy(&x, &bits, sizeof x);
  return x;
}
#endif

template <class T>
T select(bool mask, T yes, T no) {
  return mask ? yes : no;
}
inline float maxv(float a, float b) { return a > b ? a : b; }
inline float minv(float a, float b) { return a < b ? a : b; }
inline float clampv(float x, float limit) { return maxv(minv(x, limit), -limit); }
inline int64_t clampv(int64_t x, int64_t limit) { return x > limit ? limit : x < -limit ? -limit : x; }
inline float absv(float x) { return std::fabs(x); }
inline int absv(int x) { return x < 0 ? -x : x; }
inline float log2v(float x) { return std::log2(x); }
inline float rootv(float x) { return std::sqrt(x); }
inline double rootv(double x) { return std::sqrt(x); }
inline float floorv(float x) { return std::floor(x); }
inline float signv(float x) { return x > 0.0f ? 1.0f : x < 0.0f ? -1.0f : 0.0f; }
inline bool is_finite(double x) { return x - x == 0; }

}  // namespace
}  // namespace sgi
