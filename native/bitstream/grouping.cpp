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

void ungroup_categorical(const int32_t *indices, const int32_t *order, const int16_t *keys, int64_t n,
                         const int32_t *alphabets, int64_t size, int32_t *symbols) {
  for (int64_t i = 0; i < n; ++i) symbols[order[i]] = alphabets[keys[order[i]] * size + indices[i]];
}

}  // namespace sgi
