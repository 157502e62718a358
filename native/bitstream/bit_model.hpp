// Models of single bits that adapt (docs/format.md, "Bits"): the logit of a bit is the sum of what its models say. All
// integers.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace sgi {

constexpr int kCertain = 65536;  // a probability of 1
constexpr int kMinP = 16;        // the least that models give
constexpr int kMinError = 17;    // that of bits which are as certain as models say
constexpr int kLogitBits = 14;   // of a logit in 2^-8
constexpr int kMaxLogit = 3072;  // logits beyond are clipped
constexpr int kCosts = 4096;     // of probabilities in 2^-12

// How many bits a model counts at most: the fewer, the faster it follows what changes
// (docs/notes/2026-11-residual-layer.md).
constexpr uint32_t kSteady = 511, kQuick = 80;

// What the arithmetic of bits reads. No value that is rounded lies nearer to a half than 10^-5, so that every
// mathematical library gives the same integers.
struct BitTables {
  BitTables();
  std::array<uint16_t, 1 << kLogitBits> logistic;  // 65536 / (1 + exp(-x / 256)), 16 ... 65519, by x modulo 2^14
  std::array<int32_t, kSteady + 1> rate;           // 65536 * 6 / (bits seen + 16)
  std::array<float, kCosts + 1> cost;              // bits, by P(bit) in 2^-12
};
extern const BitTables kBitTables;

// What one context says of a bit: a part of its logit in 2^-16, above ten bits that count those it has seen.
struct BitModel {
  static constexpr int kCountBits = 10;

  uint32_t word = 0;  // logits modulo 2^22, so that no stream can make them overflow

  // Moves by a share of the error, bit - P(1) in 2^-16, that falls with the bits that it has seen. Not from the least
  // errors: what comes a million times would leave the range of logits.
  void learn(int32_t error, uint32_t limit) {
    if (error >= -kMinError && error <= kMinError) return;
    const uint32_t seen = word & ((1 << kCountBits) - 1);
    move((error * kBitTables.rate[seen] + (1 << 15)) >> 16);
    word += seen < limit;
  }
  void move(int32_t logit) { word += uint32_t(logit) << kCountBits; }
};

// P(1) in 2^-16 by the sum of the words of some models; what they count together is too little to matter.
inline int32_t probability_of(uint32_t words) { return kBitTables.logistic[words >> (32 - kLogitBits)]; }

// Codes a bit under models, which learn.
template <class Bits, size_t N>
void code_bit(Bits &bits, const std::array<BitModel *, N> &models, uint32_t limit, int &bit) {
  uint32_t words = 0;
  for (const BitModel *model : models) words += model->word;
  const int32_t one = probability_of(words);
  bits.code(one, bit);
  const int32_t error = bit * kCertain - one;
  for (BitModel *model : models) model->learn(error, limit);
}

// The same of one model.
template <class Bits>
void code_bit(Bits &bits, BitModel &model, uint32_t limit, int &bit) {
  code_bit(bits, std::array<BitModel *, 1>{&model}, limit, bit);
}

// Information content of a bit, from the table of its probability's first twelve bits: for decisions, not for accounts.
inline float bit_cost(int32_t one, int bit) { return kBitTables.cost[size_t((bit ? one : kCertain - one) >> 4)]; }

}  // namespace sgi
