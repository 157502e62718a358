#include "base/peak.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>

#include "base/thread_pool.hpp"

namespace sgi {

double fma_peak(int threads, Isa isa) {
  constexpr int64_t kRounds = 200000;
  constexpr int kRuns = 15;
  const PeakKernel &kernel = kernel_for<PeakKernel>(isa);
  const int workers = resolve_threads(threads);
  std::atomic<float> sink{0};  // a result that is used is computed
  double best = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    parallel_for(int64_t(workers) * 4, workers, [&](int64_t) { sink = kernel.multiply_add(kRounds); });
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    best = std::max(best, 2.0 * kPeakChains * lanes_of(isa) * kRounds * workers * 4 / seconds.count());
  }
  return best;
}

}  // namespace sgi
