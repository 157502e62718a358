#include "bitstream/read_symbols.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "bitstream/frequency_tables.hpp"

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

// Replaces the symbols at `where`, each one beyond its table's support: exponents, then mantissas by ascending
// exponent, then signs.
Reading read_escaped(RangeDecoder &decoder, const int16_t *keys, const std::vector<int32_t> &where, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  std::vector<int32_t> exponent(where.size()), magnitude(where.size());
  const int64_t start[2] = {0, int64_t(where.size())};
  if (!decoder.decode(tables.exponents, start, 1, exponent.data())) return Reading::kDamaged;
  for (int e = 0; e < int(tables.exponents.symbols(0)); ++e) {
    std::vector<int32_t> mantissa(std::size_t(std::count(exponent.begin(), exponent.end(), e)));
    if (!decoder.decode_uniform(e, int64_t(mantissa.size()), mantissa.data())) return Reading::kDamaged;
    auto next = mantissa.begin();
    for (std::size_t i = 0; i < where.size(); ++i)
      if (exponent[i] == e) magnitude[i] = *next++ + (1 << e) + tables.support[size_t(keys[size_t(where[i])])];
  }
  std::vector<int32_t> sign(where.size());
  if (!decoder.decode_uniform(1, int64_t(sign.size()), sign.data())) return Reading::kDamaged;
  for (std::size_t i = 0; i < where.size(); ++i) {
    if (magnitude[i] > kMaxMagnitude) return Reading::kTooLarge;
    symbols[where[i]] = sign[i] ? -magnitude[i] : magnitude[i];
  }
  return Reading::kSound;
}

}  // namespace

Reading read_zero_centred(RangeDecoder &decoder, const int16_t *keys, int64_t n, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  const int32_t *support = tables.support.data();
  Grouped grouped;
  if (!grouped.read(decoder, tables.models, keys, n)) return Reading::kDamaged;
  if (!ungroup_symbols(grouped.indices.data(), grouped.order.data(), keys, n, support, symbols)) return Reading::kSound;
  std::vector<int32_t> where;
  for (int64_t i = 0; i < n; ++i)
    if (symbols[i] > support[keys[i]]) where.push_back(int32_t(i));
  return read_escaped(decoder, keys, where, symbols);
}

}  // namespace sgi
