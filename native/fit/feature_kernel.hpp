// One step of the paper profile's fit on a run of seeds that hold features: from attributes to Gaussians and bits, and
// back to gradients. A lane holds a seed, which is one pixel wide.
//
// The reference, with torch, is tests/support/torch_step.
#pragma once
#include <cstdint>

#include "base/inline.hpp"
#include "fit/rounding.hpp"
#include "model/constants.hpp"
#include "model/seed_gaussians.hpp"

namespace sgi {

constexpr int kRefinements = 3;           // outputs of MLP_p that refine the steps of features, scales and offsets
constexpr int kSeedScales = 4;            // s_o and s_a
constexpr int kBatchSeeds = 128;          // that go through the networks together
constexpr int kPitch = kBatchSeeds + 16;  // of their rows: no power of two, or rows would share cache sets

// What a model's arrays measure.
struct FeatureModel {
  int per_seed, channels, features, hidden;  // K, C, D, width of MLP_c and MLP_Sigma
  int context_hidden, hash_features;         // width of MLP_p, inputs from the hash grid

  SGI_INLINE int attributes() const { return features + kSeedScales + 2 * per_seed; }
  SGI_INLINE int first_scale() const { return features; }
  SGI_INLINE int first_offset() const { return features + kSeedScales; }
  SGI_INLINE int colours() const { return per_seed * channels; }
  SGI_INLINE int shapes() const { return 3 * per_seed; }
  SGI_INLINE int context_inputs() const { return kLevelInputs + hash_features; }
  SGI_INLINE int context_outputs() const { return 2 * attributes() + kRefinements; }
  // Weights of MLP_c or MLP_Sigma with so many outputs: W1, b1, W2, b2.
  SGI_INLINE int decoder_size(int outputs) const { return hidden * (features + 1 + outputs) + outputs; }
  SGI_INLINE int decoders_size() const { return decoder_size(colours()) + decoder_size(shapes()); }
  // b1, W2 and b2 of MLP_p, and its W1.
  SGI_INLINE int rest_size() const { return context_hidden * (1 + context_outputs()) + context_outputs(); }
  SGI_INLINE int first_size() const { return context_hidden * context_inputs(); }
  // Sums over seeds: of the decoders' weights and, where bits count, of `rest` and `first`.
  SGI_INLINE int sums(bool priced) const { return decoders_size() + (priced ? rest_size() + first_size() : 0); }
  // What bits leave for their way back (BitRows).
  SGI_INLINE int bit_rows() const { return 3 * attributes() + kRefinements; }
  // Rows of a batch that its way back needs of its way forward.
  SGI_INLINE int kept_rows() const {
    return attributes() + 2 * hidden + shapes() + hash_features + context_hidden + bit_rows();
  }
  // Enough for the inputs of any layer where they lie seed by seed, filled up to whole vectors of at most 16.
  SGI_INLINE int turned_rows() const {
    const int decoders = features > hidden ? features : hidden;
    const int context = hash_features > context_hidden ? hash_features : context_hidden;
    return 16 + (decoders > context ? decoders : context);
  }
  // Which refinement an attribute's step follows.
  SGI_INLINE int group_of(int attribute) const {
    return attribute < first_scale() ? 0 : attribute < first_offset() ? 1 : 2;
  }
};

// What a step reads and what it leaves for its way back.
struct FeatureState : FeatureModel {
  int64_t count;
  const int32_t *half_pixels;              // [N, 2] centres
  const float *feature, *scales, *offset;  // [N, D], [N, 4] logarithms, [N, 2 K]
  const float *decoders;                   // W1, b1, W2, b2 of MLP_c, then of MLP_Sigma
  const float *first, *rest;               // W1 of MLP_p; b1, W2, b2
  const float *bias;                       // b1 with what W1 makes of cell size and colour step, the same for all seeds
  const float *steps;                      // [d_A] Q
  const int32_t *entry;                    // [N, resolutions, 4] of H, where each entry has entry_features
  const float *weight;                     // [N, resolutions, 4], which sum to 1
  const float *theta;                      // what trains of H
  const int8_t *signs;                     // of θ: ±1, which seeds see
  int resolutions, entry_features;
  float scale;  // of the pyramid's level
  Rounding rounding;
  bool priced;           // MLP_p runs and bits count
  uint32_t key, mirror;  // of the noise
  float share;           // of the seeds whose bits count
  float *kept;           // [batch][kept_rows][kPitch]
  float *hash_slopes;    // [N, hash_features]
};

struct FeatureGradients {
  const float *means, *covariances, *colours;  // of the Gaussians
  float price;                                 // of a bit of a seed that counts
  float *feature, *scales, *offset;            // out
};

// Floats of memory that a run needs: rows of a batch that are not kept.
SGI_INLINE int64_t scratch_floats(const FeatureModel &m) {
  const int coding = 2 * m.context_outputs() + m.context_hidden + m.hash_features;
  return int64_t(2 * m.attributes() + 5 * m.per_seed + m.colours() + m.shapes() + m.hidden + coding + m.turned_rows()) *
         kPitch;
}

// Runs are [begin, end) seeds; begin is a multiple of kBatchSeeds. `memory` holds scratch_floats(s).
struct FeatureKernel {
  // Draws, writes Gaussians and what is kept, returns bits.
  double (*forward)(const FeatureState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *memory);
  // Gradients of the values; those of what all seeds share are added to sums[s.sums(s.priced)].
  void (*backward)(const FeatureState &s, int64_t begin, int64_t end, const FeatureGradients &g, float *sums,
                   float *memory);
  // Signs of n numbers, 1 for 0; returns how many are positive.
  int64_t (*take_signs)(const float *theta, int64_t n, int8_t *signs);
  // Of the numbers [begin, end) of θ, those of one resolution: gradients through what all seeds see of their signs, and
  // `slope`, where |θ| <= 1; none elsewhere.
  void (*descend_table)(const FeatureState &s, int resolution, int64_t begin, int64_t end, float slope, float *tables);
  static const FeatureKernel portable, avx2, avx512;
};

}  // namespace sgi
