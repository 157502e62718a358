// Adaptive models of single bits, mixed by weights that adapt too (docs/format.md, "Bits of texture"). All integers.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace sgi {

constexpr int kCertain = 65536;        // a probability of 1
constexpr int kLogits = 4096;          // of probabilities in 2^-12
constexpr int kLogisticHalf = 3072;    // logits beyond are clipped
constexpr int kSeenLimit = 150;        // of the bits that a model counts
constexpr int kWeightLimit = 1 << 20;  // either way

constexpr int kMostMixed = 4;  // models that one bit has

// P(1) in 2^-16, and how many bits the model has seen, up to a limit.
struct BitModel {
  uint16_t probability;
  uint8_t seen;
};

// The models of a bit, and the two sets of weights whose sum mixes them.
struct BitContext {
  std::array<uint32_t, kMostMixed> model;
  std::array<uint32_t, 2> weights;
  int count;
};

// What a prediction leaves for the update.
struct Prediction {
  std::array<int32_t, kMostMixed> logits;
  int32_t one;  // P(1) in 2^-16
};

// What the arithmetic of bits reads. No value that is rounded lies nearer to a half than 10^-5, so that every
// mathematical library gives the same integers.
struct BitTables {
  BitTables();
  std::array<int16_t, kLogits> logit;               // 256 log(p / (1 - p)) for p = (index + 1/2) / 4096
  std::array<int32_t, 2 * kLogisticHalf> logistic;  // 65536 / (1 + exp(-x / 256)), x = index - 3072; 16 ... 65519
  std::array<int32_t, kSeenLimit + 1> rate;         // 65536 / (bits seen + 1.6)
  std::array<float, kLogits + 1> cost;              // bits, by P(bit) in 2^-12
};
extern const BitTables kBitTables;

class BitModels {
 public:
  // Models at P = 1/2 that have seen nothing, with equal weights.
  BitModels(int64_t models, int64_t sets);

  Prediction predict(const BitContext &context) const {
    return context.count == kMostMixed ? predict_by<kMostMixed>(context, kMostMixed)
                                       : predict_by<0>(context, context.count);
  }
  void update(const BitContext &context, const Prediction &prediction, int bit) {
    if (context.count == kMostMixed) return update_by<kMostMixed>(context, prediction, bit, kMostMixed);
    update_by<0>(context, prediction, bit, context.count);
  }

  // Bytes of all models and weights, and models and weights of such bytes; false if these are not of this size.
  std::vector<uint8_t> state() const;
  bool set_state(const uint8_t *bytes, int64_t count);
  // Forgets beyond `most` bits how sure models are, so that they adapt to another picture.
  void settle(int most);

 private:
  // MOST: how many models there are, if that is known when this is compiled.
  template <int MOST>
  Prediction predict_by(const BitContext &context, int count) const;
  template <int MOST>
  void update_by(const BitContext &context, const Prediction &prediction, int bit, int count);

  std::vector<BitModel> models_;
  std::vector<int32_t> weights_;  // [sets, kMostMixed] in 2^-16
};

// Information content of a bit, from the table of its probability's first twelve bits: for decisions, not for accounts.
inline float bit_cost(int32_t one, int bit) { return kBitTables.cost[(bit ? one : kCertain - one) >> 4]; }

template <int MOST>
inline Prediction BitModels::predict_by(const BitContext &context, int count) const {
  const int32_t *first = &weights_[context.weights[0] * kMostMixed];
  const int32_t *second = &weights_[context.weights[1] * kMostMixed];
  Prediction found;
  int64_t sum = 0;
  for (int i = 0; i < (MOST ? MOST : count); ++i) {
    found.logits[i] = kBitTables.logit[models_[context.model[i]].probability >> 4];
    sum += int64_t(first[i] + second[i]) * found.logits[i];
  }
  const auto mixed = int32_t(std::clamp<int64_t>(sum >> 17, -kLogisticHalf, kLogisticHalf - 1));
  found.one = kBitTables.logistic[mixed + kLogisticHalf];
  return found;
}

template <int MOST>
inline void BitModels::update_by(const BitContext &context, const Prediction &prediction, int bit, int count) {
  int32_t *first = &weights_[context.weights[0] * kMostMixed];
  int32_t *second = &weights_[context.weights[1] * kMostMixed];
  const int32_t error = bit * kCertain - prediction.one;
  for (int i = 0; i < (MOST ? MOST : count); ++i) {
    const int32_t change = (prediction.logits[i] * error) >> 16;  // logits are within 2307 either way
    first[i] = std::clamp(first[i] + change, -kWeightLimit, kWeightLimit);
    second[i] = std::clamp(second[i] + change, -kWeightLimit, kWeightLimit);
    BitModel &model = models_[context.model[i]];
    const int64_t far = bit * (kCertain - 1) - int32_t(model.probability);
    model.probability = uint16_t(model.probability + ((far * kBitTables.rate[model.seen]) >> 16));
    model.seen = uint8_t(model.seen + (model.seen < kSeenLimit));
  }
}

}  // namespace sgi
