// What the cores can do at best, to hold the kernels against.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

constexpr int kPeakChains = 12;  // enough to hide the latency of four cycles in two units

struct PeakKernel {
  float (*multiply_add)(int64_t rounds);  // `rounds` times kPeakChains independent vector multiply-adds
  static const PeakKernel portable, avx2, avx512;
};

// Floating-point operations per second of independent multiply-adds (two operations each) in registers, on `threads`
// threads at once (0 = one per core); the best of a few runs of some milliseconds.
double fma_peak(int threads, Isa isa);

}  // namespace sgi
