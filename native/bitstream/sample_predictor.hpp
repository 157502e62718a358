// Predicts samples from their neighbours by least squares that adapt to each place (docs/format.md, "Residual layer").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "bitstream/predictor_kernel.hpp"

namespace sgi {

// The predictor of one channel of a block. Rows of a block are cut into segments of 32 columns; each segment keeps
// sums of products of what samples near it were predicted from, which fade row by row, and solves for weights before
// its samples are coded. Weights that were found serve in the row below, too.
class SamplePredictor {
 public:
  static constexpr int kSegment = 32;

  // prior [inputs]: weights where nothing is known yet.
  SamplePredictor(const PredictorKernel &kernel, int64_t width, std::vector<double> prior)
      : kernel_(kernel), prior_(std::move(prior)), segments_((width + kSegment - 1) / kSegment),
        sums_(size_t(segments_) * (prior_.size() + 1) * kPredictorRow / kLine), weights_(size_t(segments_)) {}

  int inputs() const { return int(prior_.size()); }
  // Turns to a segment: finds its weights from what was learned in it and beside it, if not in the row above.
  void solve(int64_t segment) {
    segment_ = segment;
    Weights &found = weights_[size_t(segment)];
    if (found.age == Age::last_row) {
      found.age = Age::old;
      return;
    }
    found.age = Age::this_row;
    kernel_.solve(sums(segment), sums(segment - 1), sums(segment + 1), prior_.data(), inputs(), found.values.data());
  }
  // The weighted sum of inputs [kPredictorRow], by the weights of the segment: of the products, those 16 places apart
  // are added, then those 8 apart, 4, 2 and 1.
  float predict(const float *inputs) const {
    using Four = float __attribute__((vector_size(16)));
    constexpr size_t kFours = kPredictorRow / 4;
    Four sums[kFours];
    for (size_t i = 0; i < kFours; ++i) {
      Four input, weight;
      std::memcpy(&input, inputs + 4 * i, sizeof input);
      std::memcpy(&weight, &weights()[4 * i], sizeof weight);
      sums[i] = weight * input;
    }
    for (size_t half = kFours / 2; half; half /= 2)
      for (size_t i = 0; i < half; ++i) sums[i] += sums[i + half];
    return (sums[0][0] + sums[0][2]) + (sums[0][1] + sums[0][3]);
  }
  float weight(int input) const { return weights()[size_t(input)]; }
  // Learns that values [kPredictorRow], the inputs, then the sample itself, then zeros, came together in the segment.
  void learn(const float *values, float weight) { kernel_.learn(sums(segment_), values, weight, inputs()); }
  // A row is done: lets all that was learned fade.
  void fade() {
    for (Line &line : sums_)
      for (float &sum : line.sums) sum *= kFade;
    for (Weights &found : weights_) found.age = found.age == Age::this_row ? Age::last_row : Age::old;
  }

 private:
  static constexpr float kFade = 0.9f;
  static constexpr size_t kLine = 16;

  // Sums that lie in one line of the cache: vectors do not cross two.
  struct alignas(kLine * sizeof(float)) Line {
    float sums[kLine];
  };

  // When weights were found.
  enum class Age : uint8_t { old, last_row, this_row };
  struct Weights {
    alignas(16) std::array<float, kPredictorRow> values{};  // zeros behind the inputs
    Age age = Age::old;
  };

  const std::array<float, kPredictorRow> &weights() const { return weights_[size_t(segment_)].values; }
  // Those of a segment, of the nearest where there is none.
  float *sums(int64_t segment) {
    return sums_[0].sums + std::clamp<int64_t>(segment, 0, segments_ - 1) * (inputs() + 1) * kPredictorRow;
  }

  const PredictorKernel &kernel_;
  const std::vector<double> prior_;
  const int64_t segments_;
  int64_t segment_ = 0;
  std::vector<Line> sums_;        // [segments, inputs + 1, kPredictorRow]
  std::vector<Weights> weights_;  // [segments]
};

}  // namespace sgi
