// The power of a plane at frequencies, and patterns that stand out in it (sgicodec/metrics/regular_pattern.py).
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

constexpr int kPatternBlock = 8, kPatternWindow = 24;  // sides, pixels: of a block, and of the window around it
constexpr int kPatternWaves = kPatternWindow / 2;      // from 0 cycles in a window on
constexpr int kPatternFrequencies = 2 * kPatternWaves * kPatternWaves;  // (v, u) with v >= 0, then those with -v

// What is told apart. Frequencies of pattern p: own[own_end[p - 1]] up to own_end[p], which are its own, and others, to
// which they are compared. waves: weighted cosines and sines [2][kPatternWaves][kPatternWaves], from the middle of a
// window outwards, over half of it. noise: power that counts against every pattern; doubtful: ratio of powers up to
// which none is told.
struct Patterns {
  int count;
  const float *waves;
  const int32_t *own, *own_end, *others, *others_end;
  float noise, doubtful;
};

struct RegularPatternKernel {
  // The patterns that stand out most in a column of LANES blocks side by side, `rows` times [LANES], that begin at
  // `plane`, with what lies around them: ratio of powers, 0 where that is doubtful, power, and number.
  void (*find)(const Patterns &patterns, const float *plane, int64_t stride, int64_t rows, float *ratio, float *power,
               int32_t *number);
  static const RegularPatternKernel portable, avx2, avx512;
};

}  // namespace sgi
