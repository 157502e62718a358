#include "bitstream/read_symbols.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "base/error.hpp"
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

// Replaces the symbols at `where`, each one beyond its table's support: exponents, then mantissas by ascending
// exponent, then signs.
void read_escaped(RangeDecoder &decoder, const int16_t *keys, const std::vector<int32_t> &where, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  std::vector<int32_t> exponent(where.size()), magnitude(where.size());
  const int64_t start[2] = {0, int64_t(where.size())};
  decoder.decode(tables.exponents, start, 1, exponent.data());
  for (int e = 0; e < int(tables.exponents.symbols(0)); ++e) {
    std::vector<int32_t> mantissa(std::size_t(std::count(exponent.begin(), exponent.end(), e)));
    decoder.decode_uniform(e, int64_t(mantissa.size()), mantissa.data());
    auto next = mantissa.begin();
    for (std::size_t i = 0; i < where.size(); ++i)
      if (exponent[i] == e) magnitude[i] = *next++ + (1 << e) + tables.support[size_t(keys[size_t(where[i])])];
  }
  std::vector<int32_t> sign(where.size());
  decoder.decode_uniform(1, int64_t(sign.size()), sign.data());
  for (std::size_t i = 0; i < where.size(); ++i) {
    if (magnitude[i] > kMaxMagnitude)
      throw Error(Fault::corrupt,
                  "entropy: a symbol exceeds ±" + std::to_string(kMaxMagnitude) + "; the stream is damaged");
    symbols[where[i]] = sign[i] ? -magnitude[i] : magnitude[i];
  }
}

}  // namespace

void read_zero_centred(RangeDecoder &decoder, const int16_t *keys, int64_t n, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  const int32_t *support = tables.support.data();
  std::vector<int32_t> order(static_cast<std::size_t>(n)), indices(static_cast<std::size_t>(n));
  std::vector<int64_t> start(kTables + 1);
  group_by_key(keys, n, kTables, order.data(), start.data());
  decoder.decode(tables.models, start.data(), kTables, indices.data());
  if (!ungroup_symbols(indices.data(), order.data(), keys, n, support, symbols)) return;
  std::vector<int32_t> where;
  for (int64_t i = 0; i < n; ++i)
    if (symbols[i] > support[keys[i]]) where.push_back(int32_t(i));
  read_escaped(decoder, keys, where, symbols);
}

}  // namespace sgi
