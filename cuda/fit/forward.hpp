// From attributes to Gaussians and bits, a thread for each seed; native/fit computes.
#pragma once
#include "cuda/fit/state.hpp"
#include "fit/seed_forward.hpp"

namespace sgi {

SGI_KERNEL(summarize_seeds, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  for_each_seed(block, a, [&](int i) { summarize_rows(s, i, i + 1, a.decoded + int64_t(i) * s.attributes()); });
}

SGI_KERNEL(forward_seeds, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  const SeedGaussians out{a.means, a.covariances, a.colours};
  for_each_seed(block, a, [&](int i) { a.bits[i] = forward_block(s, Block(i, a.count), out); });
}

}  // namespace sgi
