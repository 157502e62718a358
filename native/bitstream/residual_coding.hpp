// The order in which a block of a residual layer is coded, for writers and readers alike (docs/format.md, "Residual
// layer").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bitstream/bit_model.hpp"
#include "bitstream/pixel_repeats.hpp"
#include "bitstream/residual_channel.hpp"
#include "bitstream/residual_context.hpp"
#include "bitstream/residual_grid.hpp"

namespace sgi {

// A block of the picture: its size, whether its first three channels are red, green and blue, and the grids of its
// channels.
struct ResidualShape {
  int64_t width, height;
  bool is_rgb;
  const std::vector<ResidualGrid> &grids;

  int channels() const { return int(grids.size()); }
};

// Codes the values of a block, given those that the rest of the stream draws there. `Bits` as in
// bitstream/bits.hpp.
template <class Bits>
class ResidualCoding {
 public:
  ResidualCoding(const ResidualShape &shape, const PredictorKernel &kernel, Bits &bits)
      : shape_(shape), bits_(bits), models_(size_t(std::min(shape.channels(), kGroups))) {
    const auto is_exact = [](const ResidualGrid &grid) { return !grid.max_error; };
    if (std::all_of(shape.grids.begin(), shape.grids.end(), is_exact))
      repeats_.emplace(shape.width, shape.height, bits);
    for (int k = 0; k < shape.channels(); ++k)
      channels_.emplace_back(k, shape.grids[size_t(channel_at(k))], shape.width, kernel);
  }

  // values [height, width, channels]. Leaves in them what a reader finds.
  void code(std::vector<int32_t> &values, const GridBlock &drawn) {
    for (int64_t y = 0; y < shape_.height; ++y) {
      for (int64_t left = 0; left < shape_.width; left += SamplePredictor::kSegment) {
        const int64_t right = std::min(shape_.width, left + SamplePredictor::kSegment);
        is_solved_ = false;
        for (int64_t x = left; x < right; ++x) code_pixel(values.data(), drawn, y, x);
      }
      for (ResidualChannel &channel : channels_) channel.end_row();
    }
  }

 private:
  static constexpr int kGroups = 3;                   // channels from the third on share their models
  static constexpr int kRuns = 7;                     // of a distance, with models of their own, on each side
  static constexpr int kModelledBits = 3;             // of a distance's bits below its unit
  static constexpr size_t kSizes = 12, kLengths = 4;  // of units, and of distances in units, that are told apart

  // The models of a channel.
  struct Models {
    std::vector<BitModel> summed = std::vector<BitModel>(kResidualModels);
    // Of the bits below a distance's unit, by its side, the unit, the runs before, and the bits before.
    std::array<BitModel, (2 * kSizes * kLengths) << kModelledBits> low;
  };

  // What a value's bits are coded by.
  struct Coded {
    const ResidualContext &context;
    Models &models;
  };

  // Green first: red and blue are predicted from it.
  int channel_at(int k) const { return shape_.is_rgb && k < 2 ? 1 - k : k; }

  void code_pixel(int32_t *values, const GridBlock &drawn, int64_t y, int64_t x) {
    const size_t channels = channels_.size(), at = size_t(y * shape_.width + x) * channels;
    const uint8_t *held = &drawn.held[at];
    int64_t found = -1;
    if (repeats_) {
      if (std::any_of(held, held + channels, [](uint8_t one) { return one; }))
        repeats_->skip(y, x);
      else
        found = repeats_->code(y, x, [&](int64_t number) { return repeats(values, at, number); });
    }
    if (found >= 0)
      std::copy_n(values + found * int64_t(channels), channels, values + at);
    else
      solve(x);
    look(drawn.values.data(), y, x);
    if (is_solved_)
      for (ResidualChannel &channel : channels_) channel.prepare(x, channels_);
    for (size_t k = 0; k < channels; ++k) {
      const auto c = size_t(channel_at(int(k)));
      if (held[c])
        hold(values[at + c], k, x);
      else if (found >= 0 && !is_solved_)
        channels_[k].note(x, {0, values[at + c], {0, 0}});
      else
        code_value(values[at + c], k, x, found >= 0);
    }
    for (ResidualChannel &channel : channels_) channel.learn();
    if (repeats_) repeats_->learn(y, x, colour_of(values + at));
  }

  uint32_t colour_of(const int32_t *pixel) const {
    uint32_t colour = 1;
    for (int c = 0; c < shape_.channels(); ++c) colour = (colour ^ uint32_t(pixel[c])) * 0x01000193u;
    return colour;
  }

  bool repeats(const int32_t *values, size_t at, int64_t number) const {
    return std::equal(values + at, values + at + shape_.channels(), values + number * shape_.channels());
  }

  // Finds the weights of the segment of a column, unless that was done.
  void solve(int64_t x) {
    if (is_solved_) return;
    for (ResidualChannel &channel : channels_) channel.solve(x);
    is_solved_ = true;
  }

  // Shows the channels what is drawn of a pixel, and around it.
  void look(const int32_t *drawn, int64_t y, int64_t x) {
    const int64_t across = shape_.channels(), down = across * shape_.width;
    const int64_t left = x ? -across : 0, above = y ? -down : 0;
    const int64_t right = x < shape_.width - 1 ? across : 0, below = y < shape_.height - 1 ? down : 0;
    for (int k = 0; k < shape_.channels(); ++k) {
      const int32_t *here = drawn + y * down + x * across + channel_at(k);
      channels_[size_t(k)].look(*here, {here[left], here[above], here[right], here[below]});
    }
  }

  // What is not coded is as it is drawn.
  void hold(int32_t &value, size_t k, int64_t x) {
    KnownValue known;
    known.value = value = channels_[k].drawn();
    channels_[k].note(x, known);
  }

  // Codes a value, unless it is known, and takes note of it.
  void code_value(int32_t &value, size_t k, int64_t x, bool is_known) {
    ResidualChannel &own = channels_[k];
    const Predicted predicted(own.predict(x, channels_));
    const ResidualContext context = ResidualContexts(channels_, k, x).find(predicted);
    if (!is_known) {
      int32_t steps = own.steps(value - predicted.middle);
      code_steps({context, models_[std::min<size_t>(k, kGroups - 1)]}, own, predicted, steps);
      value = std::clamp(predicted.middle + steps * own.step, 0, own.most);
    }
    own.expect(value, context.spread);
    own.note(x, {own.whole(std::abs(value * kFraction - predicted.exact)),
                 value,
                 {own.miss(value, context.guesses[0]), own.miss(value, context.guesses[1])}});
  }

  void bit(const Coded &coded, int node, int &value) {
    std::array<BitModel *, kResidualContexts.size()> models;
    for (size_t i = 0; i < models.size(); ++i)
      models[i] = &coded.models.summed[coded.context.models[i] + uint32_t(node)];
    code_bit(bits_, models, kSteady, value);
  }

  // A value in steps from the middle: on which side of the prediction, then how far.
  void code_steps(const Coded &coded, const ResidualChannel &own, const Predicted &predicted, int32_t &steps) {
    const int32_t least = -own.whole(predicted.middle + own.max_error);
    const int32_t most = own.whole(own.most - predicted.middle + own.max_error);
    int up = predicted.is_above ? steps >= 1 : steps >= 0;
    if (predicted.is_above ? most < 1 : least > -1)
      up = !predicted.is_above;
    else
      bit(coded, 0, up);
    const int32_t edge = predicted.is_above ? up : up - 1;
    int32_t distance = up ? steps - edge : edge - steps;
    code_distance(coded, up, up ? most - edge : edge - least, distance);
    steps = up ? edge + distance : edge - distance;
  }

  // Runs whose unit follows from the spread, doubled from the fifth on; then the bits below the unit.
  void code_distance(const Coded &coded, int up, int32_t most, int32_t &distance) {
    const int32_t spread = coded.context.spread;
    int32_t start = 0, runs = 0, size = spread < 32 ? 0 : 30 - __builtin_clz(uint32_t(spread >> 4));
    while (start + (1 << size) <= most) {
      int more = distance >= start + (1 << size);
      bit(coded, 1 + up * kRuns + std::min(runs, kRuns - 1), more);
      if (!more) break;
      start += 1 << size;
      if (++runs >= 4) ++size;
    }
    const size_t row =
        (size_t(up) * kSizes + std::min(size_t(size), kSizes - 1)) * kLengths + std::min(size_t(runs), kLengths - 1);
    BitModel *models = &coded.models.low[row << kModelledBits];
    const int32_t rest = distance - start;
    int32_t known = 0;
    for (int place = size - 1, depth = 0; place >= 0; --place, ++depth) {
      int next = rest >> place & 1;
      if (depth < kModelledBits)
        code_bit(bits_, models[(1 << depth) + known], kSteady, next);
      else
        bits_.code(kEvenOdds, next);
      known = known * 2 + next;
    }
    distance = start + known;
  }

  const ResidualShape shape_;
  Bits &bits_;
  std::vector<ResidualChannel> channels_;
  std::vector<Models> models_;
  std::optional<PixelRepeats<Bits>> repeats_;  // none where a channel may be off
  bool is_solved_ = false;                     // whether weights are those of the segment
};

}  // namespace sgi
