// Where bits go to that nobody keeps: beside a RangeEncoder and a RangeDecoder.
#pragma once
#include <cstdint>

#include "bitstream/range_coder.hpp"

namespace sgi {

constexpr int32_t kEvenOdds = 1 << 15;  // P(1) in 2^-16 of a bit that may as well be 0

// Takes bits as they are given, for models to learn from.
class BitTaker {
 public:
  void code(int32_t, int &) {}
};

}  // namespace sgi
