// A step's arguments as what native/fit computes with: a thread is a block of one seed.
#pragma once
#define LANES 1
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"
#include "fit/seed_kernel.hpp"

namespace sgi {

constexpr int kSeedThreads = 64;

namespace {

inline const StepNumbers &numbers_of(const FitArguments &a) { return *static_cast<const StepNumbers *>(a.numbers); }

inline SeedState state_of(const FitArguments &a) {
  SeedState s;
  s.channels = a.channels;
  s.opponent = a.opponent;
  s.count = a.count;
  s.hidden = a.hidden;
  s.neighbours = a.neighbours;
  s.quality = a.quality;
  s.seeds = {a.half_pixels, a.log_size};
  s.neighbour = a.neighbour;
  s.value[kColour] = a.colour;
  s.value[kShape] = a.shape;
  s.value[kOffset] = a.offset;
  s.set_networks(a.first, a.rest);
  s.set_steps(a.steps);
  s.summary = a.summary;
  s.kept = a.kept;
  s.decoded = a.decoded;
  s.rounding = Rounding(a.rounding);
  s.key = numbers_of(a).key;
  s.mirror = numbers_of(a).mirror;
  s.predicts = a.predicts != 0;
  return s;
}

inline SeedGradients gradients_of(const FitArguments &a) {
  return {a.grad_means,
          a.grad_covariances,
          a.grad_colours,
          numbers_of(a).lmbda,
          {a.grad_colour, a.grad_shape, a.grad_offset}};
}

// Sum i of partials [chunks, width], in the order of chunks.
inline float sum_of_chunks(const float *partials, int chunks, int width, int i) {
  double sum = 0;
  for (int chunk = 0; chunk < chunks; ++chunk) sum += partials[int64_t(chunk) * width + i];
  return float(sum);
}

// Calls visit(seed) for the seed of every thread.
template <int THREADS, class Arguments, class Visit>
inline void for_each_seed(const ThreadBlock<THREADS> &block, const Arguments &a, Visit visit) {
  block.each([&](int t) {
    const int seed = block.index() * THREADS + t;
    if (seed < a.count) visit(seed);
  });
}

}  // namespace
}  // namespace sgi
