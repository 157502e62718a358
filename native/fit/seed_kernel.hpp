// One step of the default profile's fit on a run of seeds: from attributes to Gaussians and bits, and back to
// gradients. A lane holds a seed.
//
// Its arithmetic is that of native/model; the reference, with torch, is tools/autograd. MLP_p sees nothing that
// it passes gradients to, so that no gradient crosses from one coding step to another.
#pragma once
#include <cstdint>

#include "base/inline.hpp"
#include "fit/rounding.hpp"
#include "model/context_inputs.hpp"

namespace sgi {

constexpr int kUnits = 8;  // distinct predictions: three colours, three shape numbers, two offsets
constexpr int kGroupUnits[kGroups] = {3, 3, 2};
constexpr int kFirstUnit[kGroups] = {0, 3, 6};
constexpr int kGammas = 2;  // shape and offset follow the amplitude
constexpr int kBatch = 8;   // blocks of LANES seeds that go back through MLP_p together

constexpr int outputs_of(int group) { return 2 * kGroupUnits[group] + 1; }
constexpr int inputs_of(int group) { return kCommonInputs + own_input_count(group); }

// What a step reads. Arrays of blocks hold LANES seeds side by side, [block][row][LANES].
struct SeedState : SeedModel {
  int64_t count;   // N
  int hidden;      // width of MLP_p
  int neighbours;  // columns of `neighbour`
  int quality;
  SeedsView seeds;
  const int32_t *neighbour;     // [N, neighbours] seeds, -1 for none
  const float *value[kGroups];  // [N, C], [N, 3], [N, 2] attributes
  const float *first[kGroups];  // W1 [hidden, inputs]
  const float *rest[kGroups];   // b1 [hidden], W2 [outputs, hidden], b2 [outputs]
  const float *base;            // [kUnits, kLevels] log2 of the base steps
  const float *gamma;           // [kGammas]
  float *summary;               // [N, kSummary]
  float *inputs;                // [block][kCommonInputs][LANES]
  float *product;               // [block][kGroups][hidden][LANES]: W1 times the common inputs
  float *kept;                  // [block][kUnits][mean, step, scale][LANES] of the last whole step
  float *decoded;               // [block][d_A][LANES]
  Rounding rounding;
  uint32_t key, mirror;  // of the noise; mirror is 0, or all ones for its negative
  bool trains_first;
  bool predicts;  // MLP_p runs; otherwise what it said last stands for a constant

  SGI_INLINE int rest_size(int g) const { return hidden * (1 + outputs_of(g)) + outputs_of(g); }
  SGI_INLINE int first_size(int g) const { return hidden * inputs_of(g); }
  // Takes networks and steps: `first` and `rest` of all groups one behind the other, base and gamma.
  SGI_INLINE void set_parameters(const float *firsts, const float *rests, const float *steps) {
    for (int g = 0; g < kGroups; ++g) {
      first[g] = firsts;
      rest[g] = rests;
      firsts += first_size(g);
      rests += rest_size(g);
    }
    base = steps;
    gamma = steps + kUnits * kLevels;
  }
  // Sums over seeds, in this order: `rest` of every group, base, gamma and, where it trains, `first` of every group.
  SGI_INLINE int sums() const {
    int total = kUnits * kLevels + kGammas;
    for (int g = 0; g < kGroups; ++g) total += rest_size(g) + (trains_first ? first_size(g) : 0);
    return total;
  }
};

struct SeedGradients {
  const float *means, *covariances, *colours;  // of the Gaussians
  float lmbda;                                 // of a bit
  float *value[kGroups];                       // out
};

// Runs are [begin, end) seeds; begin is a multiple of the lanes. `memory` holds scratch_floats(s, lanes).
struct SeedKernel {
  // What seeds tell of themselves, from exact values.
  void (*summarize)(const SeedState &s, int64_t begin, int64_t end, float *memory);
  // Inputs that do not depend on a seed's own values, from the summaries of all seeds.
  void (*gather)(const SeedState &s, int64_t begin, int64_t end, float *memory);
  void (*multiply)(const SeedState &s, int64_t begin, int64_t end, float *memory);
  // Draws or rounds, writes Gaussians and `decoded`, returns bits.
  double (*forward)(const SeedState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *memory);
  // Gradients of the values, and of all else summed over the run into sums[s.sums()].
  void (*backward)(const SeedState &s, int64_t begin, int64_t end, const SeedGradients &g, float *sums, float *memory);
  static const SeedKernel portable, avx2, avx512;
};

SGI_INLINE int64_t scratch_floats(const SeedState &s, int lanes) {
  return int64_t(kBatch * (s.hidden + s.attributes()) + s.sums()) * lanes;
}

}  // namespace sgi
