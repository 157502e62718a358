// Unsigned LEB128 integers: seven bits per byte, least significant group first, top bit = "more follows".
#pragma once
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "base/error.hpp"

namespace sgi {

constexpr int kMaxVarintBytes = 9;

// One integer from successive bytes; `next_byte` itself throws where the bytes end. Throws Error (corrupt) for more
// than nine bytes and for a needless zero last group: every integer has exactly one spelling.
template <class NextByte>
int64_t read_varint(const NextByte &next_byte) {
  uint64_t value = 0;
  for (int i = 0; i < kMaxVarintBytes; ++i) {
    const uint8_t byte = next_byte();
    value |= uint64_t(byte & 0x7F) << 7 * i;
    if (byte >= 0x80) continue;
    if (byte == 0 && i > 0)
      throw Error(Fault::corrupt, "varint: padded with a zero group; the stream was not written by an encoder");
    return int64_t(value);
  }
  throw Error(Fault::corrupt, "varint: longer than nine bytes; the stream is damaged");
}

// The integer that starts at data[at]; `at` moves behind it. Throws Error (corrupt) as `read_varint`.
int64_t decode_varint(Bytes data, size_t &at);

// Appends the shortest bytes of a value. Throws Error (usage) for a negative one.
void encode_varint(int64_t value, std::vector<uint8_t> &out);

}  // namespace sgi
