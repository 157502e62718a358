// What the bits of a value of a residual layer depend on (docs/format.md, "Residual layer").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/bit_model.hpp"
#include "bitstream/residual_channel.hpp"

namespace sgi {

constexpr int kResidualNodes = 16;  // bits of a value that have models of their own; one is not in use
constexpr std::array<uint32_t, 4> kResidualContexts{2048, 128, 1248, 1248};
constexpr uint32_t kResidualModels = [] {
  uint32_t contexts = 0;
  for (const uint32_t count : kResidualContexts) contexts += count;
  return contexts * kResidualNodes;
}();

// A prediction in sixteenths, as the nearest value and the rest.
struct Predicted {
  explicit Predicted(int32_t sixteenths)
      : exact(sixteenths), middle((sixteenths + kFraction / 2) >> 4), is_above(sixteenths >= middle * kFraction) {}

  int32_t exact, middle;
  bool is_above;  // not below the nearest value
};

struct ResidualContext {
  std::array<uint32_t, kResidualContexts.size()> models;  // of node 0
  std::array<int32_t, 2> guesses;                         // values that this one often has exactly
  int32_t spread;  // how large the error is expected to be, in sixteenths of a step
};

// Finds the context of the value of a channel at a column.
class ResidualContexts {
 public:
  ResidualContexts(const std::vector<ResidualChannel> &channels, size_t k, int64_t x)
      : own_(channels[k]), here_(own_.at(x)), first_(channels[0].at(x)), before_(k ? channels[k - 1].at(x) : nullptr),
        earlier_(k > 1 ? channels[k - 2].at(x) : before_) {}

  ResidualContext find(const Predicted &predicted) const {
    const int32_t before = before_ ? before_->magnitude : 0, earlier = earlier_ ? earlier_->magnitude : 0;
    const int32_t near = nearby(), spread = before_ ? (10 * near + 3 * before + 3 * earlier) / 16 : near;
    const uint32_t coarse = size_class(spread, 1, 32);
    const Guess copy = copied(), move = moved(copy.value);
    const std::array<uint32_t, kResidualContexts.size()> numbers{
        (coarse * kLevels + size_class(before / 4, 0, kLevels)) * kLevels + size_class(earlier / 4, 0, kLevels),
        uint32_t(predicted.middle >> own_.scale) * 8 + std::min(coarse / 2, 7u), guessed(copy, 0, predicted),
        guessed(move, 1, predicted)};
    ResidualContext found{{}, {copy.value, move.value}, spread};
    uint32_t start = 0;
    for (size_t i = 0; i < numbers.size(); ++i) {
      found.models[i] = (start + numbers[i]) * kResidualNodes;
      start += kResidualContexts[i];
    }
    return found;
  }

 private:
  static constexpr uint32_t kLevels = 8;

  struct Guess {
    int32_t value;
    uint32_t kind;
  };

  // How large a number is: 2^bits classes for each doubling.
  static uint32_t size_class(int32_t number, int bits, uint32_t classes) {
    const auto value = uint32_t(number) + 1;
    const int log = 31 - __builtin_clz(value);
    const uint32_t rest = (log >= bits ? value >> (log - bits) : value << (bits - log)) & ((1u << bits) - 1);
    return std::min((uint32_t(log) << bits) + rest, classes - 1);
  }

  // The mean magnitude around.
  int32_t nearby() const {
    const int64_t up = own_.stride;
    return (4 * here_[-1].magnitude + 4 * here_[-up].magnitude + 2 * here_[-up - 1].magnitude +
            2 * here_[-up + 1].magnitude + here_[-2].magnitude + here_[-2 * up].magnitude) /
           14;
  }

  // What the channel before, or the neighbours, did here, this channel does: nothing down or across, or the same step.
  Guess copied() const {
    const int64_t up = own_.stride;
    const int32_t left = here_[-1].value, above = here_[-up].value, corner = here_[-up - 1].value;
    if (!before_) return left == corner ? Guess{above, 1} : above == corner ? Guess{left, 2} : Guess{left, 0};
    if (before_->value == before_[-up].value) return {above, 1};
    if (before_->value == before_[-1].value) return {left, 2};
    return {left + before_->value - before_[-1].value, 3};
  }

  // The value above, and the step that the first channel made from there.
  Guess moved(int32_t copy) const {
    const int64_t up = own_.stride;
    const int32_t above = here_[-up].value;
    if (!before_) return {above, above == copy ? 0u : 3u};
    const int32_t value = above + first_->value - first_[-up].value;
    return {value, value == copy ? 1u : 2u};
  }

  // Where a guess lies from the prediction, of which kind it is, and how good those around were.
  uint32_t guessed(const Guess &guess, size_t number, const Predicted &predicted) const {
    const auto missed = [&](int64_t place) { return here_[place].misses[number]; };
    const int32_t near = missed(-1) + missed(-own_.stride), far = missed(-2) + missed(-2 * own_.stride);
    const int32_t doubt = (near < 3 ? near : near < 6 ? 3 : near < 9 ? 4 : 5) + (far > 2 ? 6 : 0);
    const int32_t off = std::clamp(own_.steps(guess.value - predicted.middle), -kFarthestMiss, kFarthestMiss);
    return ((uint32_t(off + kFarthestMiss) * 4 + guess.kind) * 12 + uint32_t(doubt)) * 2 + predicted.is_above;
  }

  const ResidualChannel &own_;
  const KnownValue *const here_, *const first_, *const before_, *const earlier_;  // of the channel, and of others
};

}  // namespace sgi
