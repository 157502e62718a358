// Symbols in the order in which the range coder takes them: by table, equal tables by position.
#pragma once
#include <cstdint>

namespace sgi {

// order [n]: positions of the keys, ascending and stable; start [count + 1]: where each key's begin. Keys are
// 0..count-1.
void group_by_key(const int16_t *keys, int64_t n, int count, int32_t *order, int64_t *start);

// The zero-centred tables side by side: table t has 2 support[t] + 2 indices from start[t] on, the last one an escape.
struct SymbolTables {
  const int32_t *support;
  const int64_t *start;
  const double *bits;  // information content of each index
};

struct Symbols {
  double bits;  // information content, without what follows escapes
  int64_t escapes;
};

// Puts indices in coding order back to their positions as symbols, index - support; an escape becomes support + 1.
Symbols ungroup_symbols(const int32_t *indices, const int32_t *order, const int16_t *tables, int64_t n,
                        const SymbolTables &all, int32_t *symbols);

// Puts indices in coding order back to their positions as symbols of alphabets [keys, size]; the information content.
double ungroup_categorical(const int32_t *indices, const int32_t *order, const int16_t *keys, int64_t n,
                           const int32_t *alphabets, const double *bits, int64_t size, int32_t *symbols);

}  // namespace sgi
