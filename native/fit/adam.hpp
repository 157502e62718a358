// Adam (Kingma and Ba 2015) on arrays of any length, the same for any number of threads.
#pragma once
#include "base/isa.hpp"
#include "fit/adam_kernel.hpp"

namespace sgi {

void adam_step(Isa isa, int threads, const AdamStep &step, const float *gradient, int64_t n, float *value, float *mean,
               float *square);

}  // namespace sgi
