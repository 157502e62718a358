#include "model/seed_gaussians.hpp"

#include <algorithm>

#include "base/isa.hpp"
#include "base/thread_pool.hpp"

namespace sgi {

void seed_gaussians(const SeedModel &model, const SeedsView &seeds, int64_t count, const double *values, int threads,
                    Isa isa, const SeedGaussians &out) {
  constexpr int64_t kRun = 1024;
  const GaussianKernel &kernel = kernel_for<GaussianKernel>(isa);
  parallel_for((count + kRun - 1) / kRun, threads, [&](int64_t run) {
    kernel.evaluate(model, seeds, count, values, run * kRun, std::min(count, (run + 1) * kRun), out);
  });
}

}  // namespace sgi
