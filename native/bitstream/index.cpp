#include "bitstream/index.hpp"

#include <algorithm>
#include <cstring>
#include <string>

#include "base/error.hpp"
#include "bitstream/varint.hpp"

namespace sgi {

namespace {

constexpr uint8_t kEndChunk[kEndBytes] = {0x45, 0x00, 0xbf, 0xa9, 0xd7, 0xcc};
constexpr size_t kOffsetBytes = 8;
constexpr int64_t kMaxUnlisted = 1 << 15;  // that are looked for one by one; every encoder writes an index

}  // namespace

std::vector<ChunkPlace> decode_index(Bytes payload, int64_t count) {
  const Bytes data{payload.data, payload.size - std::min(payload.size, kOffsetBytes)};
  const size_t wanted = 2 * size_t(count) + 1;
  std::vector<ChunkPlace> places;
  places.reserve(std::min(size_t(count), data.size / 2));  // a lying count takes no memory
  size_t fields = 0;
  int64_t stated = 0, offset = 0;
  for (size_t at = 0; at < data.size; ++fields) {
    const int64_t field = decode_varint(data, at);
    if (!fields) stated = field;
    if (fields % 2) offset = field;
    if (fields && fields % 2 == 0 && fields < wanted) places.push_back({offset, field});
  }
  if (payload.size < kOffsetBytes || fields != wanted || stated != count)
    throw Error(Fault::corrupt, "index: it does not list the " + std::to_string(count) + " tiles; the file is damaged");
  return places;
}

void check_unlisted(int64_t count) {
  if (count > kMaxUnlisted)
    throw Error(Fault::limit, "there are " + std::to_string(count) + " tiles and no sound index; at most " +
                                  std::to_string(kMaxUnlisted) + " are sought without one");
}

int64_t longest_index(int64_t count) { return int64_t(kOffsetBytes) + kMaxVarintBytes * (2 * count + 1); }

std::optional<uint64_t> index_offset(Bytes tail) {
  if (tail.size != kTrailerBytes || std::memcmp(tail.data + kTrailerBytes - kEndBytes, kEndChunk, kEndBytes)) return {};
  uint64_t offset = 0;
  for (size_t i = 0; i < kOffsetBytes; ++i) offset |= uint64_t(tail.data[i]) << 8 * i;
  return offset;
}

}  // namespace sgi
