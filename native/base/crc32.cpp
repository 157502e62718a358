#include "base/crc32.hpp"

namespace sgi {

namespace {

constexpr int kSlices = 16;

// table[k][b]: what byte b does to the checksum k bytes later.
struct Tables {
  uint32_t table[kSlices][256];

  constexpr Tables() : table{} {
    for (uint32_t byte = 0; byte < 256; ++byte) {
      uint32_t crc = byte;
      for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
      table[0][byte] = crc;
    }
    for (int slice = 1; slice < kSlices; ++slice)
      for (int byte = 0; byte < 256; ++byte) {
        const uint32_t crc = table[slice - 1][byte];
        table[slice][byte] = crc >> 8 ^ table[0][crc & 0xFF];
      }
  }
};

constexpr Tables kTables;

}  // namespace

uint32_t crc32(Bytes bytes, uint32_t before) {
  const auto &table = kTables.table;
  const uint8_t *at = bytes.data, *end = at + bytes.size;
  uint32_t crc = ~before;
  for (; end - at >= kSlices; at += kSlices) {
    uint32_t next = 0;
    for (int i = 0; i < 4; ++i) next ^= table[kSlices - 1 - i][(crc >> 8 * i & 0xFF) ^ at[i]];
    for (int i = 4; i < kSlices; ++i) next ^= table[kSlices - 1 - i][at[i]];
    crc = next;
  }
  for (; at < end; ++at) crc = crc >> 8 ^ table[0][(crc & 0xFF) ^ *at];
  return ~crc;
}

}  // namespace sgi
