// The noise that stands for quantisation while a fit trains.
#pragma once
#include "base/vector.hpp"

namespace sgi {
namespace {

// Uniform in (-1/2, 1/2), a hash of (key, column, seed): the same whatever the vector's width or the thread. The mixer
// is "lowbias32" of C. Wellons' hash-prospector. `mirror` is 0, or all ones for the negative.
inline vf noise(uint32_t key, uint32_t mirror, uint32_t column, int64_t first_seed) {
  vu x;
  for (int i = 0; i < LANES; ++i) set_lane(x, i, static_cast<uint32_t>(first_seed) + i);
  x = x * 0x9e3779b9u ^ (key + column * 0x85ebca6bu);
  x = (x ^ (x >> 16)) * 0x7feb352du;
  x = (x ^ (x >> 15)) * 0x846ca68bu;
  x = x ^ (x >> 16) ^ mirror;
  return to_floats((vi)(x >> 8)) * 0x1p-24f + (0x1p-25f - 0.5f);
}

}  // namespace
}  // namespace sgi
