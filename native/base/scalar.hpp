// Functions of numbers under the names that vector.hpp gives them for vectors: what is written once for both takes
// either.
#pragma once
#include <cmath>
#include <cstdint>

namespace sgi {
namespace {

template <class T>
T select(bool mask, T yes, T no) {
  return mask ? yes : no;
}
inline float maxv(float a, float b) { return a > b ? a : b; }
inline float minv(float a, float b) { return a < b ? a : b; }
inline float clampv(float x, float limit) { return maxv(minv(x, limit), -limit); }
inline int64_t clampv(int64_t x, int64_t limit) { return x > limit ? limit : x < -limit ? -limit : x; }
inline float absv(float x) { return __builtin_fabsf(x); }
inline int absv(int x) { return x < 0 ? -x : x; }
inline float exp2v(float x) { return std::exp2(x); }
inline float log2v(float x) { return std::log2(x); }
inline float rootv(float x) { return std::sqrt(x); }

}  // namespace
}  // namespace sgi
