#include <string>

#include "base/error.hpp"
#include "bitstream/tile.hpp"
#include "bitstream/varint.hpp"

namespace sgi {
namespace {

enum MaskKind { kAllValid, kNoneValid, kSomeValid };

[[noreturn]] void refuse(int64_t number, const char *what) {
  throw Error(Fault::corrupt, "tile " + std::to_string(number) + ": " + what + "; the stream is damaged");
}

int64_t number_of(const Header &header, Bytes payload, size_t &at) {
  const int64_t number = header.tile ? decode_varint(payload, at) : 0, count = header.grid().count();
  if (number >= count)
    throw Error(Fault::corrupt, "tile " + std::to_string(number) + " in a stream of " + std::to_string(count));
  return number;
}

}  // namespace

int64_t tile_number(const Header &header, Bytes start) {
  size_t at = 0;
  return number_of(header, start, at);
}

TileChunk decode_tile_chunk(const Header &header, Bytes payload) {
  size_t at = 0;
  const int64_t number = number_of(header, payload, at);
  if (header.masked == Masked::none) return {number, false, nullptr, payload.from(at)};
  const int64_t kind = decode_varint(payload, at);
  if (kind == kNoneValid && at == payload.size) return {number, true, nullptr, {}};
  if (kind == kAllValid) return {number, false, nullptr, payload.from(at)};
  if (kind != kSomeValid) refuse(number, "a mask of an unknown kind");
  const auto length = uint64_t(decode_varint(payload, at));
  if (length > payload.size - at) refuse(number, "ends inside its mask");
  const PixelRect rect = header.grid().rect(number);
  auto mask = std::make_shared<MaskTree>(MaskTree::read({payload.data + at, size_t(length)}, rect.width, rect.height));
  if (!mask->is_mixed()) refuse(number, "a mask that says nothing");
  return {number, false, std::move(mask), payload.from(at + size_t(length))};
}

}  // namespace sgi
