// From attributes to Gaussians and bits, a thread for each seed; native/fit computes.
#pragma once
#include "cuda/fit/state.hpp"
#include "fit/seed_forward.hpp"
#include "fit/seed_inputs.hpp"

namespace sgi {

// b1, W2 and b2 as they are now: what a prior says, and its difference.
SGI_KERNEL(add_difference, 256, FitArguments) {
  block.each([&](int t) {
    int size = 0;
    for (int g = 0; g < kGroups; ++g) size += a.hidden * (1 + outputs_of(g)) + outputs_of(g);
    const int i = block.index() * 256 + t;
    if (i < size) a.effective[i] = a.rest[i] + (a.has_difference ? a.difference[i] : 0.0f);
  });
}

SGI_KERNEL(summarize_seeds, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  for_each_seed(block, a, [&](int i) { summarize_rows(s, i, i + 1, a.decoded + int64_t(i) * s.attributes()); });
}

SGI_KERNEL(gather_inputs, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  for_each_seed(block, a, [&](int i) { gather(s, i, i + 1, nullptr); });
}

SGI_KERNEL(multiply_inputs, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  for_each_seed(block, a, [&](int i) { multiply(s, i, i + 1, nullptr); });
}

SGI_KERNEL(forward_seeds, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  const SeedGaussians out{a.means, a.covariances, a.colours};
  for_each_seed(block, a, [&](int i) {
    float hidden[kMaxHidden];
    a.bits[i] = forward_block(s, Block(i, a.count), out, hidden);
  });
}

}  // namespace sgi
