#include "fit/adam.hpp"

#include <algorithm>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int64_t kRun = 1 << 16;  // numbers: ten microseconds

}  // namespace

void adam_step(Isa isa, int threads, const AdamStep &step, const float *gradient, int64_t n, float *value, float *mean,
               float *square) {
  const AdamKernel &kernel = kernel_for<AdamKernel>(isa);
  parallel_for((n + kRun - 1) / kRun, threads, [&](int64_t run) {
    const int64_t at = run * kRun;
    kernel.move(step, gradient + at, std::min(kRun, n - at), value + at, mean + at, square + at);
  });
}

}  // namespace sgi
