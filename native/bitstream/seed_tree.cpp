#include "bitstream/seed_tree.hpp"

#include <algorithm>

#include "model/morton.hpp"

namespace sgi {

Seeds seeds_of(const std::vector<LevelSeeds> &found) {
  constexpr int kLevelBits = 5, kMaxLevel = 16;
  std::vector<int64_t> keys;
  for (const auto &[level, codes] : found) {
    const auto sorted = std::ptrdiff_t(keys.size());
    for (const int64_t code : codes) keys.push_back(code << (2 * level + kLevelBits) | (kMaxLevel - level));
    std::inplace_merge(keys.begin(), keys.begin() + sorted, keys.end());
  }
  Seeds seeds;
  seeds.corner.reserve(2 * keys.size()), seeds.log_size.reserve(keys.size());
  for (const int64_t key : keys) {
    const auto code = uint64_t(key) >> kLevelBits;
    seeds.corner.push_back(int32_t(gather_bits(code))), seeds.corner.push_back(int32_t(gather_bits(code >> 1)));
    seeds.log_size.push_back(int8_t(kMaxLevel - (key & ((1 << kLevelBits) - 1))));
  }
  return seeds;
}

}  // namespace sgi
