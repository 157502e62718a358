// Adaptive models of the bits of a residual layer, four mixed for each bit (docs/format.md, "Residual layer"). Models
// learn, and so do the weights that mix them. All integers.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/bit_model.hpp"

namespace sgi {

class MixedModels {
 public:
  static constexpr size_t kMixed = 4;

  // The models of a bit, and the set of weights that mixes them.
  struct Context {
    std::array<uint32_t, kMixed> model;
    uint32_t weights;
  };

  // Models at P = 1/2 that have seen nothing, with equal weights of sum 1.
  MixedModels(size_t models, size_t sets) : models_(models, BitModel{kCertain / 2, 0}), weights_(sets) {
    for (Weights &weights : weights_) weights.fill(kCertain / int(kMixed));
  }

  // Codes a bit under its context, all of whose numbers are `node` more, and adapts. False where `bits` has none.
  template <class Bits>
  bool code(Bits &bits, const Context &context, uint32_t node, int &bit) {
    BitModel *const models = models_.data() + node;
    Weights &weights = weights_[context.weights + node];
    std::array<int32_t, kMixed> logit;
    int64_t sum = 0;
    for (size_t i = 0; i < kMixed; ++i) {
      logit[i] = kBitTables.logit[models[context.model[i]].probability >> 4];
      sum += int64_t(weights[i]) * logit[i];
    }
    const int32_t one = probability_of(int32_t(sum >> 16));
    if (!bits.code(one, bit)) return false;
    const int32_t error = bit * kCertain - one;
    for (size_t i = 0; i < kMixed; ++i)
      weights[i] = std::clamp(weights[i] + ((logit[i] * error) >> kLearningShift), -kWeightLimit, kWeightLimit);
    for (const uint32_t number : context.model) adapt(models[number], bit);
    return true;
  }

 private:
  static constexpr int kLearningShift = 15;
  static constexpr int kWeightLimit = 1 << 20;  // either way
  using Weights = std::array<int32_t, kMixed>;  // in 2^-16

  std::vector<BitModel> models_;
  std::vector<Weights> weights_;
};

// Codes a bit under one model alone, and adapts it. False where `bits` has none.
template <class Bits>
bool code_alone(Bits &bits, BitModel &model, int &bit) {
  if (!bits.code(std::clamp<int32_t>(model.probability, 16, kCertain - 16), bit)) return false;
  adapt(model, bit);
  return true;
}

}  // namespace sgi
