// The paper profile's step without the picture: attributes → Gaussians and bits, gradients of the Gaussians → gradients
// of everything that trains. Runs of seeds are shared out to threads and their sums added in order, so that results do
// not depend on the number of threads.
#pragma once
#include <vector>

#include "fit/feature_kernel.hpp"
#include "fit/noise_key.hpp"
#include "model/hash_grid.hpp"

namespace sgi {

struct FeatureValues {
  const float *feature, *scales, *offset;  // [N, D], [N, 4] logarithms, [N, 2 K]
};

// What all seeds share: the decoders' weights, MLP_p's W1 and its b1, W2, b2, the hash grid's θ of all resolutions, and
// log2 of the attributes' base steps.
struct FeatureParameters {
  const float *decoders, *first, *rest, *tables, *steps;
};

// How a step draws. priced: MLP_p runs, for steps and bits; share: of the seeds whose bits count.
struct FeatureDrawing {
  Rounding rounding;
  bool priced;
  NoiseKey key;
  float scale, share;
};

// Gradient of λ times the entropy of `count` signs, of which some are positive, straight through each (paper, equation
// 12).
float sign_slope(int64_t positive, int64_t count, float lmbda);

class FeatureFit {
 public:
  // `model` without its hash_features, which are those of `context`.
  FeatureFit(Isa isa, int threads, const FeatureModel &model, const ContextSpec &context);

  // n seeds of one pixel in a picture of this size.
  void set_layout(const int32_t *half_pixels, int64_t n, int colour_step, int64_t width, int64_t height);
  // Bits of all seeds; 0 where they do not count.
  double forward(const FeatureValues &values, const FeatureParameters &parameters, const FeatureDrawing &drawing,
                 const SeedGaussians &out);
  // After `forward` on the same arrays. `lmbda`: of a bit; `sums` [state().sums(priced)] and `tables` [signs()], which
  // is written where bits count, receive the gradients of what all seeds share.
  void backward(const FeatureGradients &gradients, float lmbda, float *sums, float *tables);

  // Numbers θ of the hash grid.
  int64_t signs() const { return table_starts_.back(); }
  const FeatureState &state() const { return state_; }

 private:
  int64_t run_size() const;
  template <class Body>
  void over_runs(const Body &body);
  void take_shared(const FeatureParameters &parameters, float offset_scale);
  void add_partials(int64_t runs, int64_t width, float *sums) const;
  void add_constant_inputs(float *sums) const;
  void descend_tables(float lmbda, float *tables) const;

  const FeatureKernel &kernel_;
  int threads_;
  float level_inputs_[kLevelInputs] = {};  // of MLP_p, the same for all seeds
  ContextSpec context_;
  FeatureState state_{};
  std::vector<int64_t> positive_;  // signs of each resolution
  std::vector<int8_t> signs_;
  std::vector<int64_t> table_starts_{0};  // of each resolution's signs, and their end
  std::vector<int32_t> half_pixels_, entry_;
  std::vector<float> weight_, steps_, bias_, kept_, hash_slopes_, partials_;
};

}  // namespace sgi
