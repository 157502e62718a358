// The default profile's step without the picture: attributes → Gaussians and bits, gradients of the Gaussians →
// gradients of everything that trains. Runs of a fixed number of seeds are shared out to threads and their sums added
// in order, so that results do not depend on the number of threads.
#pragma once
#include <array>
#include <vector>

#include "fit/noise_key.hpp"
#include "fit/seed_kernel.hpp"

namespace sgi {

// What a step's arithmetic depends on beside the values.
struct SeedParameters {
  const float *first, *rest, *steps;  // W1 of all groups; b1, W2, b2 of all groups; base steps, then γ
};

// What a step takes over from those before it: nothing, inputs from neighbours, or all that MLP_p predicts.
enum class Reuse : int { kNothing, kInputs, kPredictions };

class SeedFit {
 public:
  SeedFit(Isa isa, int threads, int channels, int hidden, const float *opponent);

  // n seeds and the nearest of each [n, neighbours], negative for none.
  void set_layout(const SeedsView &seeds, int64_t n, const int32_t *neighbour, int neighbours, int quality);
  // Bits of all seeds; 0 without rounding.
  double forward(const std::array<const float *, kGroups> &values, const SeedParameters &parameters, Rounding rounding,
                 NoiseKey key, Reuse reuse, bool trains_first, const SeedGaussians &out);
  // After `forward` on the same arrays. `sums` [sums()] receives gradients of rest, steps and, if it trains, first;
  // nothing where predictions were kept.
  void backward(const SeedGradients &gradients, float *sums);

  int64_t count() const { return state_.count; }
  int64_t first_size() const;
  int64_t rest_size() const;
  int64_t sums() const { return state_.sums(); }
  const SeedState &state() const { return state_; }

 private:
  template <class Body>
  void over_runs(const Body &body);

  const SeedKernel &kernel_;
  int lanes_, threads_;
  SeedState state_{};
  std::vector<float> opponent_;
  std::vector<int32_t> half_pixels_, neighbour_;
  std::vector<int8_t> log_size_;
  std::vector<float> summary_, inputs_, product_, kept_, decoded_, partials_;
};

}  // namespace sgi
