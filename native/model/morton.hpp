// Morton order: two coordinates as one integer whose bits alternate between them.
#pragma once
#include <cstdint>

namespace sgi {

// Moves the bits of a 32-bit integer to the even places, and back.
inline uint64_t spread_bits(uint64_t v) {
  v = (v | v << 16) & 0x0000FFFF0000FFFF;
  v = (v | v << 8) & 0x00FF00FF00FF00FF;
  v = (v | v << 4) & 0x0F0F0F0F0F0F0F0F;
  v = (v | v << 2) & 0x3333333333333333;
  return (v | v << 1) & 0x5555555555555555;
}
inline uint32_t gather_bits(uint64_t v) {
  v &= 0x5555555555555555;
  v = (v | v >> 1) & 0x3333333333333333;
  v = (v | v >> 2) & 0x0F0F0F0F0F0F0F0F;
  v = (v | v >> 4) & 0x00FF00FF00FF00FF;
  v = (v | v >> 8) & 0x0000FFFF0000FFFF;
  return uint32_t(v | v >> 16);
}

// The code of x, y from 0, the bits of x at the even places.
inline int64_t morton(int32_t x, int32_t y) {
  return int64_t(spread_bits(uint32_t(x)) | spread_bits(uint32_t(y)) << 1);
}

}  // namespace sgi
