#include "bitstream/arrays.hpp"

#include <cstdlib>
#include <numeric>
#include <string>

#include "base/error.hpp"
#include "bitstream/bit_model.hpp"
#include "bitstream/frequency_tables.hpp"

namespace sgi {
namespace {

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

namespace {

template <class Bits>
void code_signs(Bits &bits, const std::vector<int64_t> &counts, std::vector<int32_t> &signs) {
  auto sign = signs.begin();
  for (const int64_t count : counts) {
    BitModel model;
    for (int64_t i = 0; i < count; ++i) code_bit(bits, model, kQuick, *sign++);
  }
}

}  // namespace

std::vector<uint8_t> read_signs(SymbolReader &reader, const std::vector<int64_t> &counts) {
  std::vector<int32_t> signs(size_t(std::accumulate(counts.begin(), counts.end(), int64_t(0))));
  BitReader bits(reader.decoder());
  code_signs(bits, counts, signs);
  reader.record(signs.data(), int64_t(signs.size()));
  return {signs.begin(), signs.end()};
}

BitRecorder write_signs(std::vector<int32_t> signs, const std::vector<int64_t> &counts) {
  BitRecorder bits;
  code_signs(bits, counts, signs);
  return bits;
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
