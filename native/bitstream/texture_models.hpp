// Adaptive models of single bits, mixed by weights that adapt too (docs/format.md, "Bits of texture"). All integers.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace sgi {

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

class BitModels {
 public:
  // Models at P = 1/2 that have seen nothing, with equal weights.
  BitModels(int64_t models, int64_t sets);

  Prediction predict(const BitContext &context) const;
  void update(const BitContext &context, const Prediction &prediction, int bit);

  // Bytes of all models and weights, and models and weights of such bytes; false if these are not of this size.
  std::vector<uint8_t> state() const;
  bool set_state(const uint8_t *bytes, int64_t count);
  // Forgets beyond `most` bits how sure models are, so that they adapt to another picture.
  void settle(int most);

 private:
  std::vector<BitModel> models_;
  std::vector<int32_t> weights_;  // [sets, kMostMixed] in 2^-16
};

// Information content of a bit, from the table of its probability's first twelve bits: for decisions, not for accounts.
float bit_cost(int32_t one, int bit);

// 256 log(p / (1 - p)) for p = (index + 1/2) / 4096, rounded.
int32_t logit(int index);
// 65536 / (1 + exp(-x / 256)) rounded, for x clipped to -3072 ... 3071; at least 16 and at most 65519.
int32_t logistic(int32_t x);

}  // namespace sgi
