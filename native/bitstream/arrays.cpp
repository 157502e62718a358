#include "bitstream/arrays.hpp"

#include <algorithm>
#include <cstdlib>
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

template <class Coder>
void code_weights(Coder &coder, std::vector<int64_t> &weights) {
  std::vector<int32_t> symbols;
  for (const int64_t weight : weights)  // what is too large stays so
    symbols.push_back(int32_t(std::clamp<int64_t>(weight, -INT32_MAX, INT32_MAX)));
  int table = Coder::kReads ? 0 : symbol_costs().best(symbols);
  coder.number(kTableBits, table);
  const std::vector<int16_t> tables(weights.size(), int16_t(table));
  coder.zero_centred(tables.data(), int64_t(weights.size()), symbols.data());
  weights.assign(symbols.begin(), symbols.end());
}

template <class Coder>
void code_signs(Coder &coder, const std::vector<int64_t> &counts, std::vector<uint8_t> &signs) {
  std::vector<int32_t> bits(signs.begin(), signs.end());
  auto sign = bits.begin();
  for (const int64_t count : counts) {
    BitModel model;
    for (int64_t i = 0; i < count; ++i) code_bit(coder.range(), model, kQuick, *sign++);
  }
  coder.record(bits.data(), int64_t(bits.size()));
  signs.assign(bits.begin(), bits.end());
}

template <class Coder>
void code_base(Coder &coder, int channels, int64_t rows, int64_t columns, std::vector<int64_t> &planes) {
  std::vector<int64_t> errors(size_t(rows * columns));
  const auto each = [&](int64_t *plane, auto visit) {
    for (int64_t y = 0; y < rows; ++y)
      for (int64_t x = 0; x < columns; ++x)
        visit(plane[y * columns + x], errors[size_t(y * columns + x)], base_prediction(plane, columns, x, y));
  };
  for (int channel = 0; channel < channels; ++channel) {
    int64_t *const plane = planes.data() + channel * rows * columns;
    each(plane, [](int64_t value, int64_t &error, int64_t prediction) { error = value - prediction; });
    code_weights(coder, errors);
    each(plane, [](int64_t &value, int64_t error, int64_t prediction) {
      value = error + prediction;
      if (std::abs(value) > kMaxMagnitude)
        throw Error(Fault::corrupt,
                    "base layer: a value exceeds ±" + std::to_string(kMaxMagnitude) + "; the stream is damaged");
    });
  }
}

template void code_weights(SymbolReader &coder, std::vector<int64_t> &weights);
template void code_weights(SymbolWriter &coder, std::vector<int64_t> &weights);
template void code_signs(SymbolReader &coder, const std::vector<int64_t> &counts, std::vector<uint8_t> &signs);
template void code_signs(SymbolWriter &coder, const std::vector<int64_t> &counts, std::vector<uint8_t> &signs);
template void code_base(SymbolReader &coder, int channels, int64_t rows, int64_t columns, std::vector<int64_t> &planes);
template void code_base(SymbolWriter &coder, int channels, int64_t rows, int64_t columns, std::vector<int64_t> &planes);

}  // namespace sgi
