#include "bitstream/position_flags.hpp"

#include <array>

#include "bitstream/shipped_networks.hpp"

namespace sgi {
namespace {

// P(flag = 1) in 2^-16 at log-odds 0, 1/4, 2/4 ... 6.
constexpr std::array<int, 25> kOnes = {32768, 36843, 40793, 44511, 47911, 50941, 53581, 55834, 57724,
                                       59287, 60565, 61598, 62428, 63090, 63615, 64030, 64357, 64614,
                                       64816, 64974, 65097, 65194, 65269, 65328, 65374};
constexpr int kMax = int(kOnes.size()) - 1;
constexpr int kCertain = 2 * kMax + 1;  // the row of a flag that is 1 in any case
constexpr int kPerRow = 6;              // log2 of the units of log-odds, 1/256 each, that a row stands for

}  // namespace

std::vector<int64_t> flag_frequencies() {
  std::vector<int64_t> frequencies;
  for (int row = -kMax; row <= kMax + 1; ++row) {
    const int64_t one = row > kMax ? 65536 : row >= 0 ? kOnes[size_t(row)] : 65536 - kOnes[size_t(-row)];
    frequencies.insert(frequencies.end(), {(65536 - one) << 8, one << 8});
  }
  return frequencies;
}

std::vector<LevelSeeds> code_flags(const TreeScenery &scenery, int64_t most, int threads, Isa isa,
                                   const CodeFlags &code) {
  const auto &networks = position_networks(isa);
  std::vector<int16_t> rows, of;
  return walk_tree(scenery, most, [&](const TreeBatch &batch, uint8_t *split, uint8_t *seed) {
    const auto n = size_t(batch.size());
    rows.resize(3 * n), of.resize(n);
    batch.rows(*networks[size_t(batch.child)], kPerRow, kMax, threads, rows.data());
    for (size_t i = 0; i < n; ++i) of[i] = rows[3 * i];
    if (batch.of.level() > kMinLevel) code(batch, true, of, split);
    batch.seed_rows(rows.data(), split, kCertain, of.data());
    code(batch, false, of, seed);
  });
}

}  // namespace sgi
