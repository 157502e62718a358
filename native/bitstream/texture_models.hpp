// Adaptive models of single bits, mixed by weights that adapt too (docs/format.md, "Bits of texture"). All integers.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace sgi {

constexpr int kCertain = 65536;        // a probability of 1
constexpr int kLogits = 4096;          // of probabilities in 2^-12
constexpr int kLogisticHalf = 3072;    // logits beyond are clipped
constexpr int kSeenLimit = 150;        // of the bits that a model counts
constexpr int kWeightLimit = 1 << 20;  // either way

constexpr int kMaxMixed = 4;  // models that one bit has

using MixedIntegers = int32_t __attribute__((vector_size(4 * kMaxMixed)));

// P(1) in 2^-16, and how many bits the model has seen, up to a limit.
struct BitModel {
  uint16_t probability;
  uint8_t seen;
};

// The models of a bit, and the two sets of weights whose sum mixes them.
struct BitContext {
  std::array<uint32_t, kMaxMixed> model;
  std::array<uint32_t, 2> weights;
  int count;
};

// What a prediction leaves for the update.
struct Prediction {
  MixedIntegers logits;
  int32_t one;  // P(1) in 2^-16
};

// What the arithmetic of bits reads. No value that is rounded lies nearer to a half than 10^-5, so that every
// mathematical library gives the same integers.
struct BitTables {
  BitTables();
  std::array<int16_t, kLogits> logit;                // 256 log(p / (1 - p)) for p = (index + 1/2) / 4096
  std::array<uint16_t, 2 * kLogisticHalf> logistic;  // 65536 / (1 + exp(-x / 256)), x = index - 3072; 16 ... 65519
  std::array<int32_t, kSeenLimit + 2> rate;          // 65536 / (bits seen + 1.6); 0 for one that never moves
  std::array<float, kLogits + 1> cost;               // bits, by P(bit) in 2^-12
};
extern const BitTables kBitTables;

class BitModels {
 public:
  // Models at P = 1/2 that have seen nothing, with equal weights.
  BitModels(int64_t models, int64_t sets);

  Prediction predict(const BitContext &context) const {
    return predict_by(context.count == kMaxMixed ? context.model : padded(context), context);
  }
  void update(const BitContext &context, const Prediction &prediction, int bit) {
    update_by(context.count == kMaxMixed ? context.model : padded(context), context, prediction, bit);
  }

  // Bytes of all models and weights, and models and weights of such bytes; false if these are not of this size.
  std::vector<uint8_t> state() const;
  bool set_state(const uint8_t *bytes, int64_t size);
  // Forgets beyond `most` bits how sure models are, so that they adapt to another picture.
  void settle(int most);

 private:
  using Numbers = std::array<uint32_t, kMaxMixed>;

  // The models of a context, and for those that it lacks the one that says nothing.
  Numbers padded(const BitContext &context) const;
  Prediction predict_by(const Numbers &numbers, const BitContext &context) const;
  void update_by(const Numbers &numbers, const BitContext &context, const Prediction &prediction, int bit);
  int64_t count() const { return int64_t(models_.size()) - 1; }

  std::vector<BitModel> models_;  // behind all others, one whose logit is 0 and stays so
  std::vector<int32_t> weights_;  // [sets, kMaxMixed] in 2^-16
};

// Moves a model towards a bit that it has seen, the less the more it has seen.
inline void adapt(BitModel &model, int bit) {
  const uint32_t far = bit ? kCertain - 1 - model.probability : model.probability;
  const uint32_t step = (far * uint32_t(kBitTables.rate[model.seen]) + (bit ? 0u : 0xffffu)) >> 16;
  model.probability = uint16_t(bit ? model.probability + step : model.probability - step);
  model.seen = uint8_t(model.seen + (model.seen < kSeenLimit));
}

// Information content of a bit, from the table of its probability's first twelve bits: for decisions, not for accounts.
inline float bit_cost(int32_t one, int bit) { return kBitTables.cost[(bit ? one : kCertain - one) >> 4]; }

inline BitModels::Numbers BitModels::padded(const BitContext &context) const {
  Numbers found;
  for (int i = 0; i < kMaxMixed; ++i) found[i] = i < context.count ? context.model[i] : uint32_t(count());
  return found;
}

inline Prediction BitModels::predict_by(const Numbers &numbers, const BitContext &context) const {
  const int32_t *first = &weights_[context.weights[0] * kMaxMixed];
  const int32_t *second = &weights_[context.weights[1] * kMaxMixed];
  const auto logit = [&](int i) { return int32_t(kBitTables.logit[models_[numbers[i]].probability >> 4]); };
  const auto weighted = [&](int i, int32_t one) { return int64_t(first[i] + second[i]) * one; };
  const int32_t a = logit(0), b = logit(1), c = logit(2), d = logit(3);
  const int64_t sum = (weighted(0, a) + weighted(1, b)) + (weighted(2, c) + weighted(3, d));
  const auto mixed = int32_t(std::clamp<int64_t>(sum >> 17, -kLogisticHalf, kLogisticHalf - 1));
  return {MixedIntegers{a, b, c, d}, kBitTables.logistic[mixed + kLogisticHalf]};
}

inline void BitModels::update_by(const Numbers &numbers, const BitContext &context, const Prediction &prediction,
                                 int bit) {
  const int32_t error = bit * kCertain - prediction.one;
  const MixedIntegers change = (prediction.logits * error) >> 16;  // logits are within 2307 either way
  for (const uint32_t set : context.weights) {
    MixedIntegers weights;
    std::memcpy(&weights, &weights_[set * kMaxMixed], sizeof weights);
    weights += change;
    weights = weights < kWeightLimit ? weights : MixedIntegers{} + kWeightLimit;
    weights = weights > -kWeightLimit ? weights : MixedIntegers{} - kWeightLimit;
    std::memcpy(&weights_[set * kMaxMixed], &weights, sizeof weights);
  }
  for (const uint32_t number : numbers) adapt(models_[number], bit);
}

}  // namespace sgi
