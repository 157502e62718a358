#include "bitstream/read_symbols.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sgi {
namespace {

// order [n]: positions of the keys 0..count-1, ascending and stable; start [count + 1]: where each key's begin.
void group_by_key(const int16_t *keys, int64_t n, int count, int32_t *order, int64_t *start) {
  std::fill(start, start + count + 1, int64_t(0));
  for (int64_t i = 0; i < n; ++i) ++start[keys[i] + 1];
  for (int key = 0; key < count; ++key) start[key + 1] += start[key];
  std::vector<int64_t> next(start, start + count);
  for (int64_t i = 0; i < n; ++i) order[next[keys[i]]++] = int32_t(i);
}

// Puts indices in coding order back to their positions as zero-centred symbols, index - support of their table. An
// escape, the last of a table's 2 support + 2 indices, becomes support + 1; whether there are any.
bool ungroup_symbols(const int32_t *indices, const int32_t *order, const int16_t *tables, int64_t n,
                     const int32_t *support, int32_t *symbols) {
  bool any = false;
  for (int64_t i = 0; i < n; ++i) {
    const int32_t within = support[tables[order[i]]];
    any |= indices[i] == 2 * within + 1;
    symbols[order[i]] = indices[i] - within;
  }
  return any;
}

// Indices in coding order, and the positions that they belong to.
struct Grouped {
  std::vector<int32_t> order, indices;

  bool read(RangeDecoder &decoder, const SymbolModels &models, const int16_t *keys, int64_t n) {
    order.resize(std::size_t(n)), indices.resize(std::size_t(n));
    std::vector<int64_t> start(std::size_t(models.size()) + 1);
    group_by_key(keys, n, int(models.size()), order.data(), start.data());
    return decoder.decode(models, start.data(), models.size(), indices.data());
  }
};

// Values of `bits` bits; wide ones are coded in two pieces, the high one of all first.
bool read_uniform(RangeDecoder &decoder, int bits, std::vector<int32_t> &values) {
  constexpr int kPiece = 16;
  const auto count = int64_t(values.size());
  std::fill(values.begin(), values.end(), 0);
  if (bits == 0 || count == 0) return true;
  if (bits <= kPiece) return decoder.decode_uniform(bits, count, values.data());
  std::vector<int32_t> low(values.size());
  if (!decoder.decode_uniform(bits - kPiece, count, values.data())) return false;
  if (!decoder.decode_uniform(kPiece, count, low.data())) return false;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = values[i] << kPiece | low[i];
  return true;
}

// Replaces the symbols at `where`, each one beyond its table's support: exponents, then mantissas by ascending
// exponent, then signs.
Reading read_escaped(RangeDecoder &decoder, const ZeroCentred &models, const int16_t *keys,
                     const std::vector<int32_t> &where, int32_t *symbols) {
  const auto exponents = int(models.exponents->symbols(0));
  std::vector<int32_t> exponent(where.size()), magnitude(where.size());
  const int64_t start[2] = {0, int64_t(where.size())};
  if (!decoder.decode(*models.exponents, start, 1, exponent.data())) return Reading::kDamaged;
  for (int e = 0; e < exponents; ++e) {
    std::vector<int32_t> mantissa(std::size_t(std::count(exponent.begin(), exponent.end(), e)));
    if (!read_uniform(decoder, e, mantissa)) return Reading::kDamaged;
    auto next = mantissa.begin();
    for (std::size_t i = 0; i < where.size(); ++i)
      if (exponent[i] == e) magnitude[i] = *next++ + (1 << e) + models.support[keys[where[i]]];
  }
  std::vector<int32_t> sign(where.size());
  if (!read_uniform(decoder, 1, sign)) return Reading::kDamaged;
  for (std::size_t i = 0; i < where.size(); ++i) {
    if (magnitude[i] > models.most) return Reading::kTooLarge;
    symbols[where[i]] = sign[i] ? -magnitude[i] : magnitude[i];
  }
  return Reading::kSound;
}

}  // namespace

Reading read_zero_centred(RangeDecoder &decoder, const ZeroCentred &models, const int16_t *keys, int64_t n,
                          int32_t *symbols) {
  Grouped grouped;
  if (!grouped.read(decoder, *models.models, keys, n)) return Reading::kDamaged;
  if (!ungroup_symbols(grouped.indices.data(), grouped.order.data(), keys, n, models.support, symbols))
    return Reading::kSound;
  std::vector<int32_t> where;
  for (int64_t i = 0; i < n; ++i)
    if (symbols[i] > models.support[keys[i]]) where.push_back(int32_t(i));
  return read_escaped(decoder, models, keys, where, symbols);
}

}  // namespace sgi
