// The models of texture's bits (docs/format.md, "Bits of texture"), which learn at rates of their own.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
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
  explicit BitModels(int64_t contexts) : models_(size_t(contexts)) {}

  // P(1) in 2^-16.
  int32_t predict(const BitContext &context) const {
    uint32_t words = 0;
    for (int i = 0; i < context.count; ++i) words += models_[context.number[i]].word;
    return probability_of(words);
  }
  // one: what was predicted.
  void update(const BitContext &context, int32_t one, int bit) {
    const int32_t change = (bit * kCertain - one + (1 << (context.rate - 1))) >> context.rate;
    for (int i = 0; i < context.count; ++i) models_[context.number[i]].move(change);
  }

  // What all contexts say, in 2^-16; and from bytes, each in 2^-4: false if these are not of this size.
  std::vector<int32_t> logits() const;
  bool start(Bytes bytes);

 private:
  std::vector<BitModel> models_;
};

}  // namespace sgi
