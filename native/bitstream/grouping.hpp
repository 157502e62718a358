// Symbols in the order in which the range coder takes them: by table, equal tables by position.
#pragma once
#include <cstdint>

namespace sgi {

// order [n]: positions of the keys, ascending and stable; start [count + 1]: where each key's begin. Keys are
// 0..count-1.
void group_by_key(const int16_t *keys, int64_t n, int count, int32_t *order, int64_t *start);

// Puts indices in coding order back to their positions as zero-centred symbols, index - support of their table. An
// escape, the last of a table's 2 support + 2 indices, becomes support + 1; whether there are any.
bool ungroup_symbols(const int32_t *indices, const int32_t *order, const int16_t *tables, int64_t n,
                     const int32_t *support, int32_t *symbols);

// Puts indices in coding order back to their positions as symbols of alphabets [keys, size].
void ungroup_categorical(const int32_t *indices, const int32_t *order, const int16_t *keys, int64_t n,
                         const int32_t *alphabets, int64_t size, int32_t *symbols);

}  // namespace sgi
