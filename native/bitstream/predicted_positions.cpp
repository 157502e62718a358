#include <array>

#include "bitstream/positions.hpp"
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

const Alphabets &row_alphabets() {
  static const Alphabets alphabets = [] {
    std::vector<int64_t> frequencies;
    for (int row = -kMax; row <= kMax + 1; ++row) {
      const int64_t one = row > kMax ? 65536 : row >= 0 ? kOnes[size_t(row)] : 65536 - kOnes[size_t(-row)];
      frequencies.insert(frequencies.end(), {(65536 - one) << 8, one << 8});
    }
    return Alphabets(frequencies, 2);
  }();
  return alphabets;
}

}  // namespace

Seeds read_predicted_positions(SymbolReader &reader, std::shared_ptr<const TreeScenery> scenery, int64_t most,
                               int threads, Isa isa) {
  const auto &networks = position_networks(isa);
  std::vector<int16_t> rows, of;
  std::vector<int32_t> symbols;
  const auto flags = [&](uint8_t *out) {
    symbols.resize(of.size());
    reader.categorical(row_alphabets().view(), of.data(), int64_t(of.size()), symbols.data());
    for (size_t i = 0; i < of.size(); ++i) out[i] = uint8_t(symbols[i]);
  };
  const auto code = [&](const TreeBatch &batch, uint8_t *split, uint8_t *seed) {
    const auto n = size_t(batch.size());
    rows.resize(3 * n), of.resize(n);
    batch.rows(*networks[size_t(batch.child)], kPerRow, kMax, threads, rows.data());
    for (size_t i = 0; i < n; ++i) of[i] = rows[3 * i];
    if (batch.of->level() > kMinLevel) flags(split);
    batch.seed_rows(rows.data(), split, kCertain, of.data());
    flags(seed);
    return true;
  };
  std::vector<LevelSeeds> found;
  walk_tree(std::move(scenery), most, code, found);
  return seeds_of(found);
}

}  // namespace sgi
