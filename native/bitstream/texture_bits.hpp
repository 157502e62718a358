// Where the bits of a texture layer go to, or come from.
#pragma once
#include <cmath>
#include <cstdint>
#include <vector>

#include "bitstream/range_decoder.hpp"

namespace sgi {

constexpr int32_t kEvenOdds = 1 << 15;  // P(1) in 2^-16 of a bit that may as well be 0

// Information content of bits that had these probabilities, with a logarithm for every 32 of them.
class BitAccount {
 public:
  void add(int32_t one, int bit) {
    product_ *= (bit ? one : 65536 - one) * 0x1p-16;
    if (++count_ == 32) close();
  }
  double total() {
    close();
    return total_;
  }

 private:
  void close() {
    total_ -= std::log2(product_);
    product_ = 1, count_ = 0;
  }

  double product_ = 1, total_ = 0;
  int count_ = 0;
};

// Takes bits as they are given, for models to learn from.
class BitTaker {
 public:
  void code(int32_t, int &) {}
};

// Takes bits as they are given and notes them with their probabilities.
class BitRecorder {
 public:
  void code(int32_t one, int &bit) {
    bits.push_back(bit);
    ones.push_back(one);
    account.add(one, bit);
  }
  std::vector<int32_t> bits, ones;
  BitAccount account;
};

// Reads bits from a payload, whatever is given. Throws Error as the decoder does.
class BitReader {
 public:
  explicit BitReader(RangeDecoder &decoder) : decoder_(decoder) {}
  void code(int32_t one, int &bit) { bit = decoder_.decode_bit(uint32_t(one)); }

 private:
  RangeDecoder &decoder_;
};

}  // namespace sgi
