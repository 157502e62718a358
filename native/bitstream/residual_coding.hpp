// The order in which a block of a residual layer is coded, for writers and readers alike (docs/format.md, "Residual
// layer").
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "bitstream/pixel_repeats.hpp"
#include "bitstream/residual_grid.hpp"
#include "bitstream/residual_models.hpp"
#include "bitstream/sample_predictor.hpp"

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
// bitstream/texture_bits.hpp.
template <class Bits>
class ResidualCoding {
 public:
  ResidualCoding(const ResidualShape &shape, const PredictorKernel &kernel, Bits &bits) : shape_(shape), bits_(bits) {
    const auto is_exact = [](const ResidualGrid &grid) { return !grid.max_error; };
    if (std::all_of(shape.grids.begin(), shape.grids.end(), is_exact))
      repeats_.emplace(shape.width, shape.height, bits);
    for (int k = 0; k < shape.channels(); ++k)
      channels_.emplace_back(shape, kernel, k, shape.grids[size_t(channel_at(k))]);
    for (int k = 0; k < std::min(shape.channels(), kGroups); ++k) models_.emplace_back(kModels, 2 * kSets);
  }

  // values [height, width, channels]. Leaves in them what a reader finds; false where bits end.
  bool code(std::vector<int32_t> &values, const GridBlock &drawn) {
    drawn_ = drawn.values.data();
    for (int64_t y = 0; y < shape_.height; ++y) {
      for (int64_t left = 0; left < shape_.width; left += SamplePredictor::kSegment) {
        const int64_t right = std::min(shape_.width, left + SamplePredictor::kSegment);
        is_solved_ = false;
        for (int64_t x = left; x < right; ++x)
          if (!code_pixel(values.data(), drawn.held.data(), y, x)) return false;
      }
      for (Channel &channel : channels_) channel.end_row();
    }
    return true;
  }

 private:
  static constexpr int kPad = 2, kGroups = 3;               // channels from the third on share their models
  static constexpr int kNear = 10, kDrawn = 4, kOther = 5;  // inputs: differences, those of what is drawn, of others
  static constexpr int kNodes = 64, kClasses = 64, kSets = kNodes * kClasses;
  static constexpr int kFraction = 16;     // predictions are in sixteenths of a level
  static constexpr int kModelledBits = 2;  // of a distance's bits below its unit
  static constexpr int kFarthest = 6;      // steps from a prediction to a guess that are told apart, either way
  static constexpr std::array<uint32_t, ResidualModels::kMixed> kContexts{512, 3872, 2048, 1248, 1248};
  static constexpr uint32_t kModels = (512 + 3872 + 2048 + 1248 + 1248) * kNodes;

  // What is known of a value that was coded.
  struct Known {
    int32_t difference = 0;             // from what is drawn
    int32_t magnitude = 4 * kFraction;  // of the error of its prediction, in sixteenths of a step
    int32_t value = 0;
    std::array<int32_t, 2> misses{};  // steps from its guesses, up to kFarthest
  };

  // What is known of a channel: of the row that is coded, the two above, and two more columns on either side.
  struct Channel {
    Channel(const ResidualShape &shape, const PredictorKernel &kernel, int k, const ResidualGrid &grid)
        : predictor(kernel, shape.width, prior(k)), most(grid.most), max_error(grid.max_error),
          step(2 * grid.max_error + 1), scale(std::max(0, 24 - __builtin_clz(uint32_t(grid.most) | 1))),
          stride(shape.width + 2 * kPad), known(size_t((1 + kPad) * stride)) {}

    // The weights where nothing is known: a plane through the neighbours, and the difference of the channel before.
    static std::vector<double> prior(int k) {
      std::vector<double> weights(size_t(kNear + kDrawn + std::min(k, 2) * kOther + (k ? kDrawn : 0) + 1), 0.0);
      weights[0] = 0.4, weights[1] = 0.45, weights[2] = -0.15, weights[3] = 0.1;
      if (k) weights[size_t(kNear + kDrawn + (std::min(k, 2) - 1) * kOther)] = 0.8;
      return weights;
    }
    // down: from the row that is coded, -2 to 0.
    const Known *at(int64_t down, int64_t x) const { return &known[size_t((down + kPad) * stride + x + kPad)]; }
    void end_row() {
      predictor.fade();
      std::copy(known.begin() + stride, known.end(), known.begin());
      std::fill(known.end() - stride, known.end(), Known());
    }
    // How many steps lie between values, to the nearest.
    int32_t steps(int32_t off) const { return (std::abs(off) + max_error) / step * (off < 0 ? -1 : 1); }

    SamplePredictor predictor;
    int32_t most, max_error, step;  // the largest value; by how much one may be off; between those that are coded
    int scale;                      // bits of a value below its first eight
    int64_t stride;
    std::vector<Known> known;
  };

  // Values that a sample often has exactly, and of which kind they are.
  struct Guess {
    int32_t value;
    uint32_t kind;
  };

  // What the bits of a sample depend on.
  struct Sample {
    ResidualModels::Context context;  // of node 0
    uint32_t first_set[2];            // second set of weights for the first bit, and for those that follow
    int32_t guesses[2];
    int group, spread;  // spread: how large the error is expected to be, in sixteenths of a step
  };

  // Green first: red and blue are predicted from it.
  int channel_at(int k) const { return shape_.is_rgb && k < 2 ? 1 - k : k; }

  int32_t drawn_at(int channel, int64_t y, int64_t x) const {
    x = std::clamp<int64_t>(x, 0, shape_.width - 1), y = std::clamp<int64_t>(y, 0, shape_.height - 1);
    return drawn_[(y * shape_.width + x) * shape_.channels() + channel];
  }

  // How large a value is: 2^bits classes for each doubling.
  static uint32_t size_class(uint32_t value, int bits, uint32_t classes) {
    ++value;
    const int log = 31 - __builtin_clz(value);
    const uint32_t rest = (log >= bits ? value >> (log - bits) : value << (bits - log)) & ((1u << bits) - 1);
    return std::min((uint32_t(log) << bits) + rest, classes - 1);
  }

  // Writes what a sample is predicted from; returns how much that is.
  int inputs(int k, int64_t y, int64_t x, float *out) const {
    constexpr int8_t near[kNear][2] = {{0, -1}, {-1, 0}, {-1, -1}, {-1, 1},  {0, -2},
                                       {-2, 0}, {-2, 1}, {-1, 2},  {-2, -1}, {-1, -2}};
    constexpr int8_t other[kOther][2] = {{0, 0}, {0, -1}, {-1, 0}, {-1, 1}, {-1, -1}};
    int n = 0;
    const Channel &own = channels_[size_t(k)];
    for (const auto &[down, across] : near) out[n++] = float(own.at(down, x + across)->difference);
    n += drawn_differences(channel_at(k), y, x, out + n);
    for (int j = std::max(0, k - 2); j < k; ++j)
      for (const auto &[down, across] : other) out[n++] = float(channels_[size_t(j)].at(down, x + across)->difference);
    if (k) n += drawn_differences(channel_at(k - 1), y, x, out + n);
    const int32_t left = own.at(0, x - 1)->value, above = own.at(-1, x)->value;
    const int32_t plane = left + above - own.at(-1, x - 1)->value;
    out[n++] = float(std::clamp(plane, std::min(left, above), std::max(left, above)) - drawn_at(channel_at(k), y, x));
    return n;
  }

  int drawn_differences(int channel, int64_t y, int64_t x, float *out) const {
    const int32_t middle = drawn_at(channel, y, x);
    out[0] = float(drawn_at(channel, y, x - 1) - middle), out[1] = float(drawn_at(channel, y - 1, x) - middle);
    out[2] = float(drawn_at(channel, y, x + 1) - middle), out[3] = float(drawn_at(channel, y + 1, x) - middle);
    return kDrawn;
  }

  bool code_pixel(int32_t *values, const uint8_t *held, int64_t y, int64_t x) {
    const int channels = shape_.channels();
    const size_t at = size_t(y * shape_.width + x) * size_t(channels);
    int64_t found = -1;
    if (repeats_) {
      const bool is_held = std::any_of(held + at, held + at + channels, [](uint8_t one) { return one; });
      if (is_held)
        repeats_->skip(y, x);
      else if (!repeats_->code(y, x, [&](int64_t number) { return repeats(values, at, number); }, found))
        return false;
    }
    if (found >= 0) {
      repeat(values, at, found, y, x);
    } else {
      solve(x);
      for (int k = 0; k < channels; ++k) {
        const size_t c = at + size_t(channel_at(k));
        if (held[c])
          values[c] = hold(k, y, x);
        else if (!code_value(values[c], k, y, x, false))
          return false;
      }
    }
    if (repeats_) repeats_->learn(y, x, colour_of(values + at));
    return true;
  }

  uint32_t colour_of(const int32_t *pixel) const {
    uint32_t colour = 1;
    for (int c = 0; c < shape_.channels(); ++c) colour = (colour ^ uint32_t(pixel[c])) * 0x01000193u;
    return colour;
  }

  bool repeats(const int32_t *values, size_t at, int64_t number) const {
    return std::equal(values + at, values + at + shape_.channels(), values + number * shape_.channels());
  }

  void repeat(int32_t *values, size_t at, int64_t number, int64_t y, int64_t x) {
    for (int k = 0; k < shape_.channels(); ++k) {
      const int c = channel_at(k);
      int32_t &value = values[at + size_t(c)];
      value = values[number * shape_.channels() + c];
      if (is_solved_)
        code_value(value, k, y, x, true);
      else
        note(channels_[size_t(k)], x, {value - drawn_at(c, y, x), 0, value, {0, 0}});
    }
  }

  // Finds the weights of the segment of a column, unless that was done.
  void solve(int64_t x) {
    if (is_solved_) return;
    for (Channel &channel : channels_) channel.predictor.solve(x / SamplePredictor::kSegment);
    is_solved_ = true;
  }

  // What is not coded is as it is drawn.
  int32_t hold(int k, int64_t y, int64_t x) {
    Known known;
    known.value = drawn_at(channel_at(k), y, x);
    note(channels_[size_t(k)], x, known);
    return known.value;
  }

  // Codes a value, unless it is known, and learns from it.
  bool code_value(int32_t &value, int k, int64_t y, int64_t x, bool is_known) {
    Channel &own = channels_[size_t(k)];
    float values[kPredictorRow]{};
    const int count = inputs(k, y, x, values);
    const int32_t drawn = drawn_at(channel_at(k), y, x);
    const double predicted = drawn + own.predictor.predict(values), most = own.most;
    const auto exact = int32_t(std::floor((predicted > 0 ? predicted < most ? predicted : most : 0) * kFraction + 0.5));
    const int32_t middle = (exact + kFraction / 2) >> 4, fraction = exact - middle * kFraction;
    const Sample context = sample_context(k, y, x, middle, fraction);
    if (!is_known) {
      int32_t steps = own.steps(value - middle);
      if (!code_steps(context, own, middle, fraction >= 0, steps)) return false;
      value = std::clamp(middle + steps * own.step, 0, own.most);
    }
    values[count] = float(value - drawn);
    const auto spread = float(context.spread);
    own.predictor.learn(values, 1 / (1 + spread * spread * (0.6f / (kFraction * kFraction))));
    const auto miss = [&](int32_t guess) { return std::min(kFarthest, std::abs(own.steps(value - guess))); };
    note(own, x,
         {value - drawn,
          std::abs((value * kFraction - exact) / own.step),
          value,
          {miss(context.guesses[0]), miss(context.guesses[1])}});
    return true;
  }

  // Keeps what a sample was, also beyond the ends of a row.
  void note(Channel &own, int64_t x, const Known &known) {
    const int64_t first = x ? x : -kPad, last = x == shape_.width - 1 ? x + kPad : x;
    for (int64_t i = first; i <= last; ++i) own.known[size_t(own.at(0, i) - own.known.data())] = known;
  }

  // What the channel before, or the neighbours, did here, this channel does: nothing down or across, or the same step.
  Guess copied(int k, int64_t x) const {
    const int64_t up = channels_[size_t(k)].stride;
    const Known *own = channels_[size_t(k)].at(0, x);
    const int32_t left = own[-1].value, above = own[-up].value, corner = own[-up - 1].value;
    if (!k) return left == corner ? Guess{above, 1} : above == corner ? Guess{left, 2} : Guess{left, 0};
    const Known *before = channels_[size_t(k - 1)].at(0, x);
    if (before->value == before[-up].value) return {above, 1};
    if (before->value == before[-1].value) return {left, 2};
    return {left + before->value - before[-1].value, 3};
  }

  // The sample above, and the step that the first channel made from there.
  Guess moved(int k, int64_t x, int32_t copy) const {
    const int64_t up = channels_[size_t(k)].stride;
    const int32_t above = channels_[size_t(k)].at(0, x)[-up].value;
    if (!k) return {above, above == copy ? 0u : 3u};
    const Known *first = channels_[0].at(0, x);
    const int32_t value = above + first->value - first[-up].value;
    return {value, value == copy ? 1u : 2u};
  }

  // Where a guess lies from the prediction, of which kind it is, and how good those around were.
  uint32_t guess_context(const Channel &own, const Known *here, const Guess &guess, int number, int32_t middle) const {
    const auto missed = [&](int64_t place) { return here[place].misses[size_t(number)]; };
    const int32_t near = missed(-1) + missed(-own.stride), far = missed(-2) + missed(-2 * own.stride);
    const int32_t doubt = (near < 3 ? near : near < 6 ? 3 : near < 9 ? 4 : 5) + (far > 2 ? 6 : 0);
    const int32_t place = std::clamp(own.steps(guess.value - middle), -kFarthest, kFarthest) + kFarthest;
    return (uint32_t(place) * 4 + guess.kind) * 12 + uint32_t(doubt);
  }

  Sample sample_context(int k, int64_t y, int64_t x, int32_t middle, int32_t fraction) const {
    const Channel &own = channels_[size_t(k)];
    const Known *here = own.at(0, x);
    const int64_t up = own.stride;
    const int32_t near = (4 * here[-1].magnitude + 4 * here[-up].magnitude + 2 * here[-up - 1].magnitude +
                          2 * here[-up + 1].magnitude + here[-2].magnitude + here[-2 * up].magnitude) /
                         14;
    const int32_t before = k ? channels_[size_t(k - 1)].at(0, x)->magnitude : 0;
    const int32_t earlier = k > 1 ? channels_[size_t(k - 2)].at(0, x)->magnitude : before;
    const int32_t spread = !k       ? near
                           : k == 1 ? (10 * near + 6 * before) / 16
                                    : (10 * near + 3 * before + 3 * earlier) / 16;
    const auto level = [](int32_t sixteenths) { return size_class(uint32_t(sixteenths / 4), 0, 11); };
    const int c = channel_at(k);
    const int32_t gradient = std::abs(drawn_at(c, y, x + 1) - drawn_at(c, y, x - 1)) +
                             std::abs(drawn_at(c, y + 1, x) - drawn_at(c, y - 1, x));
    const uint32_t quarter = own.step > 1 ? 1 : uint32_t(fraction + 8) >> 2, is_above = fraction >= 0;
    const uint32_t coarse = size_class(uint32_t(spread), 1, 32);
    const Guess copy = copied(k, x), move = moved(k, x, copy.value);
    const std::array<uint32_t, ResidualModels::kMixed> context{
        size_class(uint32_t(spread), 3, 128) * 4 + quarter, (coarse * 11 + level(before)) * 11 + level(earlier),
        (uint32_t(middle) >> own.scale) * 8 + std::min(coarse / 2, 7u),
        guess_context(own, here, copy, 0, middle) * 2 + is_above,
        guess_context(own, here, move, 1, middle) * 2 + is_above};
    Sample found{};
    uint32_t start = 0;
    for (size_t i = 0; i < ResidualModels::kMixed; ++i) {
      found.context.model[i] = (start + context[i]) * kNodes;
      start += kContexts[i];
    }
    found.context.weights[0] = size_class(uint32_t(spread), 2, kClasses);
    found.first_set[0] = size_class(uint32_t(before / 4), 1, 32) * 2 + is_above;
    found.first_set[1] = size_class(uint32_t(4 * gradient / own.step), 1, 24);
    found.guesses[0] = copy.value, found.guesses[1] = move.value;
    found.group = std::min(k, kGroups - 1), found.spread = spread;
    return found;
  }

  bool bit(const Sample &sample, int node, int &value) {
    ResidualModels::Context context = sample.context;
    for (uint32_t &model : context.model) model += uint32_t(node);
    context.weights[0] += uint32_t(node * kClasses);
    context.weights[1] = uint32_t(kSets + node * kClasses) + sample.first_set[node > 1];
    return models_[size_t(sample.group)].code(bits_, context, value);
  }

  // A value in steps from the middle: on which side of the prediction, then how far.
  bool code_steps(const Sample &sample, const Channel &own, int32_t middle, bool is_above, int32_t &steps) {
    const int32_t least = -((middle + own.max_error) / own.step);
    const int32_t most = (own.most - middle + own.max_error) / own.step;
    int up = is_above ? steps >= 1 : steps >= 0;
    if (is_above ? most < 1 : least > -1)
      up = !is_above;
    else if (!bit(sample, is_above ? 0 : 1, up))
      return false;
    const int32_t edge = is_above ? up : up - 1;
    int32_t distance = up ? steps - edge : edge - steps;
    if (!code_distance(sample, up, up ? most - edge : edge - least, distance)) return false;
    steps = up ? edge + distance : edge - distance;
    return true;
  }

  // Runs whose unit follows from the spread, doubled from the fifth on; then the bits below the unit.
  bool code_distance(const Sample &sample, int up, int32_t most, int32_t &distance) {
    const int nodes = 2 + up * 31;
    const int log = sample.spread < 32 ? 0 : 30 - __builtin_clz(uint32_t(sample.spread >> 4));
    int32_t start = 0, runs = 0, size = log;
    while (start + (1 << size) <= most) {
      int more = distance >= start + (1 << size);
      if (!bit(sample, nodes + std::min(runs, 11), more)) return false;
      if (!more) break;
      start += 1 << size;
      if (++runs >= 4) ++size;
    }
    int32_t rest = distance - start, known = 0;
    for (int place = size - 1, depth = 0; place >= 0; --place, ++depth) {
      int next = rest >> place & 1;
      const int node = nodes + 12 + std::min(runs, 4) * 3 + (depth ? 1 + (known & 1) : 0);
      if (depth < kModelledBits ? !bit(sample, node, next) : !bits_.code(kCertain / 2, next)) return false;
      known = known * 2 + next;
    }
    distance = start + known;
    return true;
  }

  const ResidualShape shape_;
  Bits &bits_;
  const int32_t *drawn_ = nullptr;
  std::vector<Channel> channels_;
  std::vector<ResidualModels> models_;
  std::optional<PixelRepeats<Bits>> repeats_;  // none where a channel may be off
  bool is_solved_ = false;                     // whether weights are those of the segment
};

}  // namespace sgi
