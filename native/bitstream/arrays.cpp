#include "bitstream/arrays.hpp"

#include <string>

#include "base/error.hpp"
#include "bitstream/base_planes.hpp"
#include "bitstream/frequency_tables.hpp"

namespace sgi {
namespace {

constexpr int kPredictorBits = 2, kWeightBits = 4, kProbabilityBits = 8;

// Channels whose errors predict those of `channel`.
std::vector<size_t> base_references(size_t channel) {
  if (channel == 0) return {};
  if (channel == 1) return {0};
  return {0, channel - 1};
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
  const auto size = size_t(rows * columns);
  std::vector<std::vector<int64_t>> errors;
  std::vector<int64_t> base;
  base.reserve(size_t(channels) * size);
  for (size_t channel = 0; channel < size_t(channels); ++channel) {
    const std::vector<size_t> references = base_references(channel);
    const int predictor = reader.number(kPredictorBits);
    const std::vector<int32_t> codes = reader.values(kWeightBits, int64_t(references.size()));
    const int table = reader.number(kTableBits);
    const std::vector<int32_t> rest = reader.zero_centred(table, int64_t(size));
    std::vector<int64_t> error(size, 4);
    for (size_t r = 0; r < references.size(); ++r)
      for (size_t i = 0; i < size; ++i) error[i] += (codes[r] - 8) * errors[references[r]][i];
    for (size_t i = 0; i < size; ++i) error[i] = rest[i] + (error[i] >> 3);
    base.insert(base.end(), error.begin(), error.end());
    if (!add_predictions(base.data() + channel * size, rows, columns, predictor, kMaxMagnitude))
      throw Error(Fault::corrupt,
                  "base layer: a value exceeds ±" + std::to_string(kMaxMagnitude) + "; the stream is damaged");
    errors.push_back(std::move(error));
  }
  return base;
}

}  // namespace sgi
