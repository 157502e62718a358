// From gradients of Gaussians back to those of attributes and of the steps.
//
// A block takes a chunk of seeds, kSeedThreads at a time. A thread has a seed; then it has a base step or a γ and adds
// over the seeds, in their order. A chunk ends as one row of sums, and rows are added in order.
#pragma once
#include "cuda/fit/state.hpp"
#include "fit/seed_descent.hpp"
#include "fit/seed_gradients.hpp"

namespace sgi {

namespace {

// What a block's seeds leave for the sums over them.
struct DescentMemory {
  float base[kUnits][kSeedThreads];  // gradients of the base steps of the level ...
  int32_t level[kSeedThreads];       // ... that is this
  float gamma[kGammas][kSeedThreads];
};

// Takes what `descend_group` adds to the sums of one seed.
struct SeedSink {
  DescentMemory *memory;
  int thread;

  void add(int row, float v) const { memory->gamma[row - kUnits * kLevels][thread] = v; }
  void add_to_lane(int row, int, float v) const {
    memory->base[row / kLevels][thread] = v;
    memory->level[thread] = row % kLevels;
  }
};

inline void descend_seed(const FitArguments &a, const SeedState &s, int seed, const SeedSink &sink) {
  const Block one(seed, a.count);
  const SeedGradients g = gradients_of(a);
  const int64_t row = int64_t(seed) * s.attributes();
  const float *decoded = s.decoded + row;
  float *slopes = a.slopes + row;
  read_gradients(s, one, decoded, g, slopes);
  const float loudness = loudness_of(s, decoded);
  for (int group = 0; group < kGroups; ++group) {
    if (s.rounding == Rounding::kNone)
      pass_group(s, one, group, slopes, g);
    else
      descend_group(s, one, group, loudness, decoded, slopes, g, sink);
  }
}

// What the seeds of a round have for step i.
inline float sum_of_round(const DescentMemory &memory, int seeds, int i) {
  float sum = 0.0f;
  for (int n = 0; n < seeds; ++n) {
    if (i >= kUnits * kLevels) sum += memory.gamma[i - kUnits * kLevels][n];
    if (i < kUnits * kLevels && memory.level[n] == i % kLevels) sum += memory.base[i / kLevels][n];
  }
  return sum;
}

}  // namespace

// Gradients of values and, where these are not exact, partials [chunks, kSteps].
SGI_KERNEL(descend_seeds, kSeedThreads, FitArguments) {
  SGI_SHARED(DescentMemory, memory);
  const SeedState s = state_of(a);
  const int begin = block.index() * a.chunk, end = begin + a.chunk < a.count ? begin + a.chunk : a.count;
  float *out = a.partials + int64_t(block.index()) * kSteps;
  for (int first = begin; first < end; first += kSeedThreads) {
    const int seeds = end - first < kSeedThreads ? end - first : kSeedThreads;
    block.each([&](int t) {
      if (t < seeds) descend_seed(a, s, first + t, {&memory, t});
    });
    if (s.rounding == Rounding::kNone) continue;
    block.each([&](int t) {
      for (int i = t; i < kSteps; i += kSeedThreads)
        out[i] = (first == begin ? 0.0f : out[i]) + sum_of_round(memory, seeds, i);
    });
  }
}

SGI_KERNEL(sum_chunks, kSeedThreads, FitArguments) {
  block.each([&](int t) {
    const int i = block.index() * kSeedThreads + t;
    if (i < kSteps) a.grad_steps[i] = sum_of_chunks(a.partials, a.chunks, kSteps, i);
  });
}

}  // namespace sgi
