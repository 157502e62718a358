// What is known of one channel of a block while a residual layer is coded (docs/format.md, "Residual layer").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "bitstream/residual_grid.hpp"
#include "bitstream/sample_predictor.hpp"

namespace sgi {

constexpr int kFraction = 16;     // predictions are in sixteenths of a level
constexpr int kFarthestMiss = 6;  // steps from a value to a guess that are told apart

// What is known of a value that was coded.
struct KnownValue {
  int32_t magnitude = 4 * kFraction;  // of the error of its prediction, in sixteenths of a step
  int32_t value = 0;
  std::array<int32_t, 2> misses{};  // steps from its guesses, up to kFarthestMiss
};

// A channel: its values of the row that is coded and of the two above, with two more columns on either side, and from
// what the next value is predicted.
class ResidualChannel {
 public:
  // place: how many channels are coded before this one.
  ResidualChannel(int place, const ResidualGrid &grid, int64_t width, const PredictorKernel &kernel)
      : most(grid.most), max_error(grid.max_error), step(2 * grid.max_error + 1),
        scale(std::max(0, 28 - __builtin_clz(uint32_t(grid.most) | 1))), place(place), stride(width + 2 * kPad),
        width_(width), known_(size_t((1 + kPad) * stride)), differences_(known_.size()),
        predictor_(kernel, width, prior(place)) {}

  // What is known at a column of the row that is coded; `stride` before it, of the row above.
  const KnownValue *at(int64_t x) const { return &known_[place_of(x)]; }
  // How far a value is from what is drawn; rows as above.
  const float *difference(int64_t x) const { return &differences_[place_of(x)]; }
  // Keeps what a value is, also beyond the ends of the row.
  void note(int64_t x, const KnownValue &known) {
    const int64_t first = x ? x : -kPad, last = x == width_ - 1 ? x + kPad : x;
    for (int64_t i = first; i <= last; ++i) {
      known_[place_of(i)] = known;
      differences_[place_of(i)] = float(known.value - drawn_);
    }
  }
  void end_row() {
    predictor_.fade();
    begin_row(known_), begin_row(differences_);
  }

  // How many steps lie between values, to the nearest.
  int32_t steps(int32_t off) const { return whole(std::abs(off) + max_error) * (off < 0 ? -1 : 1); }
  // Whole steps of a distance.
  int32_t whole(int32_t distance) const { return step == 1 ? distance : distance / step; }
  // How far a guess is off, as far as that is told.
  int32_t miss(int32_t value, int32_t guess) const { return std::min(kFarthestMiss, std::abs(steps(value - guess))); }

  void solve(int64_t x) { predictor_.solve(x / SamplePredictor::kSegment); }
  // Takes what is drawn of a pixel, and to the left of it, above, to the right, below.
  void look(int32_t here, const std::array<int32_t, 4> &around) {
    drawn_ = here;
    for (size_t i = 0; i < around.size(); ++i) slopes_[i] = float(around[i] - here);
  }
  // Begins the prediction of the value at x with all that is known before its pixel, of all channels in their order.
  void prepare(int64_t x, const std::vector<ResidualChannel> &channels);
  // The prediction in sixteenths, once the channels before have their values at x.
  int32_t predict(int64_t x, const std::vector<ResidualChannel> &channels) {
    float sum = predicted_;
    int input = early_;
    for (int k = place - others(place); k < place; ++k, ++input) {
      values_[size_t(input)] = *channels[size_t(k)].difference(x);
      sum += predictor_.weight(input) * values_[size_t(input)];
    }
    const double found = drawn_ + double(sum), limit = most;
    return int32_t((found > 0 ? found < limit ? found : limit : 0) * kFraction + 0.5);
  }
  // Takes the value that came, and how far it was expected to be from its prediction, in sixteenths of a step.
  void expect(int32_t value, int32_t spread) {
    values_[size_t(predictor_.inputs())] = float(value - drawn_);
    const auto off = float(spread);
    weight_ = 1 / (1 + off * off * (0.6f / (kFraction * kFraction)));
  }
  // Learns from the value that was taken last, once.
  void learn() {
    if (weight_ > 0) predictor_.learn(values_.data(), weight_);
    weight_ = 0;
  }

  int32_t drawn() const { return drawn_; }

  const int32_t most, max_error, step;  // the largest value; by how much one may be off; between those that are coded
  const int scale;                      // bits of a value below its first four
  const int place;
  const int64_t stride;  // values of a row

 private:
  static constexpr int kPad = 2;
  static constexpr int kNear = 10, kDrawn = 4, kOther = 4;  // inputs: differences, those of what is drawn, of others

  // How many channels before serve a prediction.
  static int others(int place) { return std::min(place, 2); }
  static std::vector<double> prior(int place);
  // Of rows that are kept the first goes, and behind the last comes one of which nothing is known.
  template <class T>
  void begin_row(std::vector<T> &rows) const {
    std::copy(rows.begin() + stride, rows.end(), rows.begin());
    std::fill(rows.end() - stride, rows.end(), T());
  }
  size_t place_of(int64_t x) const { return size_t(kPad * stride + x + kPad); }

  int64_t width_;
  std::vector<KnownValue> known_;
  std::vector<float> differences_;
  SamplePredictor predictor_;
  // Of the pixel that is coded:
  int32_t drawn_ = 0;
  std::array<float, kDrawn> slopes_{};                     // of what is drawn
  alignas(64) std::array<float, kPredictorRow> values_{};  // inputs, then the value itself, then zeros
  int early_ = 0;                                          // inputs that are known before the pixel
  float predicted_ = 0;                                    // by these
  float weight_ = 0;                                       // of the value that came; 0: learned
};

}  // namespace sgi
