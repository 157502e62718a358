#include "bitstream/positions.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "bitstream/arrays.hpp"
#include "model/morton.hpp"

namespace sgi {
namespace {

constexpr int kCountBits = 32, kShiftBits = 4;
constexpr int kUpperBits = 5;  // of a gap of the mean size; those below are as good as random, and are coded as such

// How many pixels lie between a seed and the one before, row by row.
std::vector<int64_t> gaps_of(int64_t width, int64_t height, const Seeds &seeds) {
  std::vector<int64_t> gaps;
  for (size_t i = 0; i < seeds.log_size.size(); ++i) {
    const int64_t x = seeds.corner[2 * i], y = seeds.corner[2 * i + 1];
    if (seeds.log_size[i] || x < 0 || y < 0 || x >= width || y >= height)
      throw Error(Fault::usage, "positions: a seed that is no pixel of the tile");
    gaps.push_back(y * width + x);
  }
  std::sort(gaps.begin(), gaps.end());
  int64_t last = -1;
  for (int64_t &gap : gaps) {
    const int64_t pixel = gap;
    gap -= last + 1, last = pixel;
    if (gap < 0) throw Error(Fault::usage, "positions: two seeds share one pixel");
  }
  return gaps;
}

int shift_of(const std::vector<int64_t> &gaps) {
  int64_t mean = 0;
  for (const int64_t gap : gaps) mean += gap;
  mean /= int64_t(gaps.size());
  int bits = 0;
  while (mean >> bits) ++bits;
  return std::clamp(bits - kUpperBits, 0, (1 << kShiftBits) - 1);
}

Seeds seeds_of(int64_t width, int64_t height, const std::vector<int64_t> &gaps) {
  std::vector<uint64_t> codes;
  int64_t pixel = -1;
  for (const int64_t gap : gaps) {
    pixel += 1 + gap;
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

}  // namespace

template <class Coder>
void code_positions(Coder &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds) {
  std::vector<int64_t> gaps = gaps_of(width, height, seeds);
  auto count = uint32_t(gaps.size());
  coder.number(kCountBits, count);
  if (count > most) throw Error(Fault::limit, "positions: more than " + std::to_string(most) + " seeds");
  if (!count) return;
  int shift = Coder::kReads ? 0 : shift_of(gaps);
  coder.number(kShiftBits, shift);
  gaps.resize(count);
  std::vector<int32_t> lower(count);
  for (size_t i = 0; i < count; ++i) {
    const int64_t upper = gaps[i] >> shift;
    lower[i] = int32_t(gaps[i] - (upper << shift)), gaps[i] = upper & 1 ? -(upper + 1) / 2 : upper / 2;
  }
  coder.values(shift, lower);
  code_weights(coder, gaps);
  for (size_t i = 0; i < count; ++i) gaps[i] = ((gaps[i] < 0 ? -2 * gaps[i] - 1 : 2 * gaps[i]) << shift) + lower[i];
  seeds = seeds_of(width, height, gaps);
}

template void code_positions(SymbolReader &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds);
template void code_positions(SymbolWriter &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds);

}  // namespace sgi
