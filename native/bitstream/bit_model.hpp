// A model of single bits that adapts, and the tables of all such models (docs/format.md, "Bits"). All integers.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

namespace sgi {

constexpr int kCertain = 65536;      // a probability of 1
constexpr int kLogits = 4096;        // of probabilities in 2^-12
constexpr int kLogisticHalf = 3072;  // logits beyond are clipped
constexpr int kSeenLimit = 150;      // of the bits that a model counts

// P(1) in 2^-16, and how many bits the model has seen, up to a limit.
struct BitModel {
  uint16_t probability;
  uint8_t seen;
};

// What the arithmetic of bits reads. No value that is rounded lies nearer to a half than 10^-5, so that every
// mathematical library gives the same integers.
struct BitTables {
  BitTables();
  std::array<int16_t, kLogits> logit;                // 256 log(p / (1 - p)) for p = (index + 1/2) / 4096
  std::array<uint16_t, 2 * kLogisticHalf> logistic;  // 65536 / (1 + exp(-x / 256)), x = index - 3072; 16 ... 65519
  std::array<int32_t, kSeenLimit + 1> rate;          // 65536 / (bits seen + 1.6)
  std::array<float, kLogits + 1> cost;               // bits, by P(bit) in 2^-12
};
extern const BitTables kBitTables;

// P(1) in 2^-16 of a logit in 2^-8.
inline int32_t probability_of(int32_t logit) {
  return kBitTables.logistic[size_t(std::clamp(logit, -kLogisticHalf, kLogisticHalf - 1) + kLogisticHalf)];
}

// Moves a model towards a bit that it has seen, the less the more it has seen.
inline void adapt(BitModel &model, int bit) {
  const uint32_t far = bit ? kCertain - 1 - model.probability : model.probability;
  const uint32_t step = (far * uint32_t(kBitTables.rate[model.seen]) + (bit ? 0u : 0xffffu)) >> 16;
  model.probability = uint16_t(bit ? model.probability + step : model.probability - step);
  model.seen = uint8_t(model.seen + (model.seen < kSeenLimit));
}

// Information content of a bit, from the table of its probability's first twelve bits: for decisions, not for accounts.
inline float bit_cost(int32_t one, int bit) { return kBitTables.cost[(bit ? one : kCertain - one) >> 4]; }

}  // namespace sgi
