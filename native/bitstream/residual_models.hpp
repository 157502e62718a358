// Adaptive models of the bits of a residual layer, five mixed for each bit (docs/format.md, "Residual layer"). The same
// arithmetic as for texture (bitstream/texture_models.hpp), with more models and faster weights. All integers.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/texture_models.hpp"

namespace sgi {

class ResidualModels {
 public:
  static constexpr size_t kMixed = 5;

  // The models of a bit, and the two sets of weights whose sum mixes them.
  struct Context {
    std::array<uint32_t, kMixed> model;
    std::array<uint32_t, 2> weights;
  };

  // Models at P = 1/2 that have seen nothing, with equal weights.
  ResidualModels(size_t models, size_t sets) : models_(models, BitModel{kCertain / 2, 0}) {
    Weights first;
    first.fill(kWeightSum / int(kMixed));
    weights_.assign(sets, first);
  }

  // Codes a bit under its context, and adapts. False where `bits` has none.
  template <class Bits>
  bool code(Bits &bits, const Context &context, int &bit) {
    std::array<int32_t, kMixed> logit;
    for (size_t i = 0; i < kMixed; ++i) logit[i] = kBitTables.logit[models_[context.model[i]].probability >> 4];
    const Weights &first = weights_[context.weights[0]], &second = weights_[context.weights[1]];
    int64_t sum = 0;
    for (size_t i = 0; i < kMixed; ++i) sum += int64_t(first[i] + second[i]) * logit[i];
    const auto mixed = int32_t(std::clamp<int64_t>(sum >> 17, -kLogisticHalf, kLogisticHalf - 1));
    const int32_t one = kBitTables.logistic[mixed + kLogisticHalf];
    if (!bits.code(one, bit)) return false;
    adapt(context, logit, bit * kCertain - one, bit);
    return true;
  }

 private:
  static constexpr int kLearningShift = 14;
  static constexpr int kWeightSum = 60000;      // of a context's weights at first, in 2^-16
  using Weights = std::array<int32_t, kMixed>;  // in 2^-16

  void adapt(const Context &context, const std::array<int32_t, kMixed> &logit, int32_t error, int bit) {
    for (const uint32_t set : context.weights)
      for (size_t i = 0; i < kMixed; ++i) {
        int32_t &weight = weights_[set][i];
        weight = std::clamp(weight + ((logit[i] * error) >> kLearningShift), -kWeightLimit, kWeightLimit);
      }
    for (const uint32_t number : context.model) sgi::adapt(models_[number], bit);
  }

  std::vector<BitModel> models_;
  std::vector<Weights> weights_;
};

}  // namespace sgi
