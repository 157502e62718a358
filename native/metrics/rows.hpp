// Vectors at the end of rows.
#pragma once
#include "base/vector.hpp"

namespace sgi {
namespace {

inline int count_left(int64_t x, int64_t width) { return int(width - x < LANES ? width - x : LANES); }

// Rows as callers have them, without padding: lanes behind the last are 0.
inline vf load_some(const float *p, int count) {
  if (count == LANES) return load(p);
  float lanes[LANES] = {};
  std::memcpy(lanes, p, size_t(count) * sizeof(float));
  return load(lanes);
}

inline void store_some(float *p, vf v, int count) {
  if (count == LANES) return store(p, v);
  float lanes[LANES];
  store(lanes, v);
  std::memcpy(p, lanes, size_t(count) * sizeof(float));
}

// All bits where a column lies in the row.
inline vi inside(int64_t x, int64_t width) { return iota() < float(width - x); }

inline vf zero_unless(vi mask, vf v) { return (vf)((vi)v & mask); }

}  // namespace
}  // namespace sgi
