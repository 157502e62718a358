#include "bitstream/byte_planes.hpp"

namespace sgi {

std::vector<uint8_t> joined_planes(Bytes planes, int width) {
  const size_t count = planes.size / width;
  std::vector<uint8_t> joined(planes.size);
  for (size_t i = 0; i < count; ++i) {
    uint32_t value = 0;
    for (int byte = 0; byte < width; ++byte) value |= uint32_t(planes.data[byte * count + i]) << 8 * byte;
    if (width == 2) value = value >> 1 ^ (0 - (value & 1));
    for (int byte = 0; byte < width; ++byte) joined[i * width + byte] = uint8_t(value >> 8 * byte);
  }
  return joined;
}

}  // namespace sgi
