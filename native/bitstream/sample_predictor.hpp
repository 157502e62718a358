// Predicts samples from their neighbours by least squares that adapt to each place (docs/format.md, "Residual layer").
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "bitstream/predictor_kernel.hpp"

namespace sgi {

// The predictor of one channel of a block. Rows of a block are cut into segments of 32 columns; each segment keeps
// sums of products of what samples near it were predicted from, which fade row by row, and solves for weights before
// its samples are coded.
class SamplePredictor {
 public:
  static constexpr int kSegment = 32;

  // prior [inputs]: weights where nothing is known yet.
  SamplePredictor(const PredictorKernel &kernel, int64_t width, std::vector<double> prior)
      : kernel_(kernel), prior_(std::move(prior)), segments_((width + kSegment - 1) / kSegment),
        sums_(size_t(segments_) * (prior_.size() + 1) * kPredictorRow), weights_(prior_) {}

  int inputs() const { return int(prior_.size()); }
  // Finds the weights of a segment from what was learned in it and beside it.
  void solve(int64_t segment) {
    segment_ = segment;
    kernel_.solve(sums(segment), sums(segment - 1), sums(segment + 1), prior_.data(), inputs(), weights_.data());
  }
  // The weighted sum of `inputs` by the weights last solved for.
  double predict(const float *inputs) const {
    double sum = 0;
    for (size_t i = 0; i < weights_.size(); ++i) sum += weights_[i] * double(inputs[i]);
    return sum;
  }
  // Learns that values [kPredictorRow], the inputs, then the sample itself, then zeros, came together in the segment
  // last solved for.
  void learn(const float *values, float weight) { kernel_.learn(sums(segment_), values, weight, inputs()); }
  // Lets all that was learned fade: a row is done.
  void fade() {
    for (float &sum : sums_) sum *= kFade;
  }

 private:
  static constexpr float kFade = 0.9f;

  // Those of a segment, of the nearest where there is none.
  float *sums(int64_t segment) {
    return sums_.data() + std::clamp<int64_t>(segment, 0, segments_ - 1) * (inputs() + 1) * kPredictorRow;
  }

  const PredictorKernel &kernel_;
  const std::vector<double> prior_;
  const int64_t segments_;
  int64_t segment_ = 0;
  std::vector<float> sums_;  // [segments, inputs + 1, kPredictorRow]
  std::vector<double> weights_;
};

}  // namespace sgi
