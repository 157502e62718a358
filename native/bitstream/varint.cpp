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

}  // namespace sgi
