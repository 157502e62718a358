#include "bitstream/grouping.hpp"

#include <algorithm>
#include <vector>

namespace sgi {

void group_by_key(const int16_t *keys, int64_t n, int count, int32_t *order, int64_t *start) {
  std::fill(start, start + count + 1, int64_t(0));
  for (int64_t i = 0; i < n; ++i) ++start[keys[i] + 1];
  for (int key = 0; key < count; ++key) start[key + 1] += start[key];
  std::vector<int64_t> next(start, start + count);
  for (int64_t i = 0; i < n; ++i) order[next[keys[i]]++] = int32_t(i);
}

Symbols ungroup_symbols(const int32_t *indices, const int32_t *order, const int16_t *tables, int64_t n,
                        const SymbolTables &all, int32_t *symbols) {
  Symbols found{0.0, 0};
  for (int64_t i = 0; i < n; ++i) {
    const int16_t table = tables[order[i]];
    const int32_t support = all.support[table];
    found.bits += all.bits[all.start[table] + indices[i]];
    found.escapes += indices[i] == 2 * support + 1;
    symbols[order[i]] = indices[i] - support;
  }
  return found;
}

double ungroup_categorical(const int32_t *indices, const int32_t *order, const int16_t *keys, int64_t n,
                           const int32_t *alphabets, const double *bits, int64_t size, int32_t *symbols) {
  double total = 0;
  for (int64_t i = 0; i < n; ++i) {
    const int64_t row = keys[order[i]] * size;
    const int32_t symbol = alphabets[row + indices[i]];
    total += bits[row + symbol];
    symbols[order[i]] = symbol;
  }
  return total;
}

}  // namespace sgi
