// Sums of the lanes of several vectors at a time, for units compiled once per instruction set (base/isa.hpp).
#pragma once
#include <utility>

#include "base/vector.hpp"

namespace sgi {
namespace {

// Where element `i` of merge's first (ODD = 0) or second operand comes from among a's elements followed by b's.
template <int UNIT, int SPAN>
constexpr int32_t merge_index(int i, int odd) {
  constexpr int HALF = SPAN / UNIT / 2;
  const int unit = i % SPAN / UNIT;
  return (unit < HALF ? 0 : LANES) + i / SPAN * SPAN + (unit % HALF * 2 + odd) * UNIT + i % UNIT;
}

// Adds neighbouring units of UNIT lanes: each SPAN of the result holds those of a, then those of b.
template <int UNIT, int SPAN, size_t... I>
inline vf merge(vf a, vf b, std::index_sequence<I...>) {
#if defined(__clang__)
  return __builtin_shufflevector(a, b, merge_index<UNIT, SPAN>(I, 0)...) +
         __builtin_shufflevector(a, b, merge_index<UNIT, SPAN>(I, 1)...);
#else
  return __builtin_shuffle(a, b, vi{merge_index<UNIT, SPAN>(I, 0)...}) +
         __builtin_shuffle(a, b, vi{merge_index<UNIT, SPAN>(I, 1)...});
#endif
}

// Horizontal sums of v[0..COUNT), COUNT <= LANES: lane i of the result is the sum of v[i]. Pairs are merged until one
// vector is left, first within the four lanes that shuffle cheaply, then across them.
template <int COUNT, int SUMMED = 1>
inline vf horizontal_sums(const vf *v) {
  if constexpr (SUMMED == LANES) {
    return v[0];
  } else {
    constexpr int UNIT = SUMMED < 4 ? 1 : 4, SPAN = SUMMED < 4 ? 4 : LANES, PAIRS = (COUNT + 1) / 2;
    vf next[PAIRS];
    for (int i = 0; i < PAIRS; ++i)
      next[i] = merge<UNIT, SPAN>(v[2 * i], 2 * i + 1 < COUNT ? v[2 * i + 1] : vf{}, std::make_index_sequence<LANES>{});
    return horizontal_sums<PAIRS, 2 * SUMMED>(next);
  }
}

// Adds the horizontal sums of v[0..COUNT) to out[0..COUNT).
template <int COUNT>
inline void add_sums(const vf *v, float *out) {
  constexpr int STEP = COUNT < LANES ? COUNT : LANES;
  for (int at = 0; at < COUNT; at += STEP) {
    vf part[STEP];
    for (int i = 0; i < STEP; ++i) part[i] = at + i < COUNT ? v[at + i] : vf{};
    const vf sums = horizontal_sums<STEP>(part);
    for (int i = 0; i < STEP && at + i < COUNT; ++i) out[at + i] += sums[i];
  }
}

}  // namespace
}  // namespace sgi
