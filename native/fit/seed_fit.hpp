// The default profile's step without the picture: attributes → Gaussians and bits, gradients of the Gaussians →
// gradients of attributes and of the steps. Runs of a fixed number of seeds are shared out to threads and their sums
// added in order, so that results do not depend on the number of threads.
#pragma once
#include <array>
#include <vector>

#include "fit/noise_key.hpp"
#include "fit/seed_kernel.hpp"

namespace sgi {

class SeedFit {
 public:
  // first: W1 of all groups; rest: b1, W2 and b2 of all groups.
  SeedFit(Isa isa, int threads, int channels, int hidden, const float *first, const float *rest);

  // n seeds and the nearest of each [n, neighbours], negative for none.
  void set_layout(const SeedsView &seeds, int64_t n, const int32_t *neighbour, int neighbours, int colour_step);
  // Bits of all seeds; 0 without rounding. steps [kSteps]: base steps, then γ. predicts: whether MLP_p runs; otherwise
  // what it said last stands.
  double forward(const std::array<const float *, kGroups> &values, const float *steps, Rounding rounding, NoiseKey key,
                 bool predicts, const SeedGaussians &out);
  // After `forward` on the same arrays. `slopes` [kSteps] receives the gradients of the steps, 0 without rounding.
  void backward(const SeedGradients &gradients, float *slopes);

  int64_t count() const { return state_.count; }
  const SeedState &state() const { return state_; }

 private:
  template <class Body>
  void over_runs(const Body &body);

  const SeedKernel &kernel_;
  int lanes_, threads_;
  SeedState state_{};
  std::vector<float> first_, rest_;
  std::vector<int32_t> half_pixels_, neighbour_;
  std::vector<int8_t> log_size_;
  std::vector<float> summary_, kept_, decoded_, partials_;
};

}  // namespace sgi
