#include <string>

#include "base/error.hpp"
#include "bitstream/tile.hpp"
#include "bitstream/varint.hpp"

namespace sgi {

int64_t tile_number(const Header &header, Bytes start) {
  size_t at = 0;
  const int64_t number = header.tile ? decode_varint(start, at) : 0, count = header.grid().count();
  if (number >= count)
    throw Error(Fault::corrupt, "tile " + std::to_string(number) + " in a stream of " + std::to_string(count));
  return number;
}

}  // namespace sgi
