#include "bitstream/arrays.hpp"

#include <cstdlib>
#include <string>

#include "base/error.hpp"
#include "bitstream/frequency_tables.hpp"

namespace sgi {
namespace {

constexpr int kProbabilityBits = 8;

// The prediction of element (x, y) of a plane of `columns` columns: the mean of those to the left and above; at an edge
// the one that is there stands for both.
int64_t base_prediction(const int64_t *plane, int64_t columns, int64_t x, int64_t y) {
  const int64_t *at = plane + y * columns + x;
  const int64_t west = x ? at[-1] : y ? at[-columns] : 0, north = y ? at[-columns] : west;
  return (west + north) >> 1;
}

}  // namespace

std::vector<int64_t> read_weights(SymbolReader &reader, int64_t count) {
  const int table = reader.number(kTableBits);
  const std::vector<int32_t> symbols = reader.zero_centred(table, count);
  return {symbols.begin(), symbols.end()};
}

std::vector<uint8_t> read_signs(SymbolReader &reader, const std::vector<int64_t> &counts) {
  std::vector<int64_t> frequencies;
  for (const int32_t code : reader.values(kProbabilityBits, int64_t(counts.size()))) {
    const int64_t one = (2 * int64_t(code) + 1) << 15;
    frequencies.insert(frequencies.end(), {kTotalFrequency - one, one});
  }
  const Alphabets alphabets(frequencies, 2);
  std::vector<int16_t> levels;
  for (size_t level = 0; level < counts.size(); ++level)
    levels.insert(levels.end(), size_t(counts[level]), int16_t(level));
  std::vector<int32_t> flags(levels.size());
  reader.categorical(alphabets.view(), levels.data(), int64_t(levels.size()), flags.data());
  return {flags.begin(), flags.end()};
}

std::vector<int64_t> read_base(SymbolReader &reader, int channels, int64_t rows, int64_t columns) {
  std::vector<int64_t> base;
  base.reserve(size_t(channels * rows * columns));
  for (int channel = 0; channel < channels; ++channel) {
    const std::vector<int64_t> errors = read_weights(reader, rows * columns);
    base.insert(base.end(), errors.begin(), errors.end());
    int64_t *const plane = base.data() + channel * rows * columns;
    for (int64_t y = 0; y < rows; ++y)
      for (int64_t x = 0; x < columns; ++x) {
        int64_t &value = plane[y * columns + x];
        value += base_prediction(plane, columns, x, y);
        if (std::abs(value) > kMaxMagnitude)
          throw Error(Fault::corrupt,
                      "base layer: a value exceeds ±" + std::to_string(kMaxMagnitude) + "; the stream is damaged");
      }
  }
  return base;
}

}  // namespace sgi
