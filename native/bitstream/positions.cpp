#include "bitstream/positions.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "bitstream/arrays.hpp"
#include "model/morton.hpp"

namespace sgi {

Seeds read_positions(SymbolReader &reader, int64_t width, int64_t height, int64_t most) {
  constexpr int kCountBits = 32, kShiftBits = 4;
  const int64_t count = uint32_t(reader.number(kCountBits));
  if (count > most) throw Error(Fault::limit, "positions: more than " + std::to_string(most) + " seeds");
  if (!count) return {};
  const int shift = reader.number(kShiftBits);
  const std::vector<int32_t> lower = reader.values(shift, count);
  const std::vector<int64_t> upper = read_weights(reader, count);
  std::vector<uint64_t> codes;
  int64_t pixel = -1;
  for (size_t i = 0; i < size_t(count); ++i) {
    const int64_t folded = upper[i] < 0 ? -2 * upper[i] - 1 : 2 * upper[i];
    pixel += 1 + (folded << shift) + lower[i];
    if (pixel >= width * height) throw Error(Fault::corrupt, "positions: a seed beyond the tile");
    codes.push_back(uint64_t(morton(int32_t(pixel % width), int32_t(pixel / width))));
  }
  std::sort(codes.begin(), codes.end());
  Seeds seeds{{}, std::vector<int8_t>(codes.size(), 0)};
  for (const uint64_t code : codes) {
    seeds.corner.push_back(int32_t(gather_bits(code)));
    seeds.corner.push_back(int32_t(gather_bits(code >> 1)));
  }
  return seeds;
}

}  // namespace sgi
