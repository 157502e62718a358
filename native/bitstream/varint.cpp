#include "bitstream/varint.hpp"

namespace sgi {

int64_t decode_varint(Bytes data, size_t &at) {
  const size_t start = at;
  return read_varint([&] {
    if (at >= data.size)
      throw Error(Fault::corrupt, "varint: cut short after " + std::to_string(data.size - start) + " bytes");
    return data.data[at++];
  });
}

void encode_varint(int64_t value, std::vector<uint8_t> &out) {
  if (value < 0) throw Error(Fault::usage, "varint: " + std::to_string(value) + " is negative");
  uint64_t rest = uint64_t(value);
  for (; rest > 0x7F; rest >>= 7) out.push_back(uint8_t(rest | 0x80));
  out.push_back(uint8_t(rest));
}

}  // namespace sgi
