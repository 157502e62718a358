// What the cores can do at best, to hold the kernels against.
#pragma once
#include <string>

namespace sgi {

// Floating-point operations per second of independent multiply-adds (two operations each) in registers, on `threads`
// threads at once (0 = one per core); the best of a few runs of some milliseconds. `isa` as for choose_kernel.
double fma_peak(int threads, const std::string &isa);

}  // namespace sgi
