// One step of the default profile's fit on a run of seeds: from attributes to Gaussians and bits, and back to
// gradients. A lane holds a seed.
//
// Its arithmetic is that of native/model; the reference, with torch, is tests/support/torch_step. MLP_p is the shipped
// one and does not train. It sees nothing that it passes gradients to, so that no gradient goes through it.
#pragma once
#include <cstdint>

#include "base/inline.hpp"
#include "fit/rounding.hpp"
#include "model/context_inputs.hpp"

namespace sgi {

constexpr int kUnits = 8;  // distinct predictions: three colours, three shape numbers, two offsets
constexpr int kGroupUnits[kGroups] = {3, 3, 2};
constexpr int kFirstUnit[kGroups] = {0, 3, 6};
constexpr int kGammas = 2;                          // shape and offset follow the amplitude
constexpr int kSteps = kUnits * kLevels + kGammas;  // base steps of every unit and level, then γ

constexpr int outputs_of(int group) { return 2 * kGroupUnits[group] + 1; }
constexpr int inputs_of(int group) { return kCommonInputs + own_input_count(group); }

// What a step reads. Arrays of blocks hold LANES seeds side by side, [block][row][LANES].
struct SeedState : SeedModel {
  int64_t count;   // N
  int hidden;      // width of MLP_p
  int neighbours;  // columns of `neighbour`
  int colour_step;
  SeedsView seeds;
  const int32_t *neighbour;     // [N, neighbours] seeds, -1 for none
  const float *value[kGroups];  // [N, C], [N, 3], [N, 2] attributes
  const float *first[kGroups];  // W1 [hidden, inputs]
  const float *rest[kGroups];   // b1 [hidden], W2 [outputs, hidden], b2 [outputs]
  const float *base;            // [kUnits, kLevels] log2 of the base steps
  const float *gamma;           // [kGammas]
  float *summary;               // [N, kSummary]
  float *kept;                  // [block][kUnits][mean, step, scale][LANES]: what MLP_p said last
  float *decoded;               // [block][d_A][LANES]
  Rounding rounding;
  uint32_t key, mirror;  // of the noise; mirror is 0, or all ones for its negative
  bool predicts;         // MLP_p runs; otherwise what it said last stands

  SGI_INLINE int rest_size(int g) const { return hidden * (1 + outputs_of(g)) + outputs_of(g); }
  SGI_INLINE int first_size(int g) const { return hidden * inputs_of(g); }
  // Takes the networks, `first` and `rest` of all groups one behind the other.
  SGI_INLINE void set_networks(const float *firsts, const float *rests) {
    for (int g = 0; g < kGroups; ++g) {
      first[g] = firsts;
      rest[g] = rests;
      firsts += first_size(g);
      rests += rest_size(g);
    }
  }
  SGI_INLINE void set_steps(const float *steps) {
    base = steps;
    gamma = steps + kUnits * kLevels;
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
  // Draws or rounds, writes Gaussians and `decoded`, returns bits.
  double (*forward)(const SeedState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *memory);
  // Gradients of the values, and those of the steps summed over the run into sums[kSteps], where values are not exact.
  void (*backward)(const SeedState &s, int64_t begin, int64_t end, const SeedGradients &g, float *sums, float *memory);
  static const SeedKernel portable, avx2, avx512;
};

SGI_INLINE int64_t scratch_floats(const SeedState &s, int lanes) { return int64_t(s.attributes() + kSteps) * lanes; }

}  // namespace sgi
