#include <algorithm>

#include "bitstream/position_flags.hpp"
#include "bitstream/positions.hpp"

namespace sgi {

Seeds read_predicted_positions(SymbolReader &reader, const TreeScenery &scenery, int64_t most, int threads, Isa isa) {
  static const Alphabets alphabets(flag_frequencies(), 2);
  std::vector<int32_t> symbols;
  return seeds_of(code_flags(scenery, most, threads, isa,
                             [&](const TreeBatch &, bool, const std::vector<int16_t> &rows, uint8_t *flags) {
                               symbols.resize(rows.size());
                               reader.categorical(alphabets.view(), rows.data(), int64_t(rows.size()), symbols.data());
                               std::copy(symbols.begin(), symbols.end(), flags);
                             }));
}

}  // namespace sgi
