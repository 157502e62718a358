// Adaptive models of the bits of texture (docs/format.md, "Bits of texture"): the logit of a bit is the sum of what
// each of its contexts says. All integers.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/bit_model.hpp"

namespace sgi {

constexpr int kMaxContexts = 4;  // that one bit has

// The numbers of a bit's contexts. rate: what it changes is its error divided by this power of two.
struct BitContext {
  std::array<uint32_t, kMaxContexts> number;
  int count, rate;
};

class BitModels {
 public:
  // Contexts that say nothing yet.
  explicit BitModels(int64_t contexts) : logits_(size_t(contexts)) {}

  // P(1) in 2^-16.
  int32_t predict(const BitContext &context) const {
    uint32_t sum = 0;
    for (int i = 0; i < context.count; ++i) sum += logits_[context.number[i]];
    return probability_of(int32_t(sum) >> kFraction);
  }
  // one: what was predicted.
  void update(const BitContext &context, int32_t one, int bit) {
    const auto change = uint32_t((bit * kCertain - one + (1 << (context.rate - 1))) >> context.rate);
    for (int i = 0; i < context.count; ++i) logits_[context.number[i]] += change;
  }

  // What all contexts say, in 2^-16; and from bytes, each in 2^-4: false if these are not of this size.
  const std::vector<uint32_t> &logits() const { return logits_; }
  bool start(const uint8_t *bytes, int64_t size);

 private:
  static constexpr int kFraction = 8;  // digits behind those of a logit in 2^-8

  std::vector<uint32_t> logits_;  // modulo 2^32, so that no stream can make them overflow
};

}  // namespace sgi
