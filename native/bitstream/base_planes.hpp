// How values of the base layer's planes are predicted (docs/format.md, "Base layer").
#pragma once
#include <cstdint>

namespace sgi {

// The prediction of element (x, y) of a plane of `columns` columns: the mean of those to the left and above; at an edge
// the one that is there stands for both.
inline int64_t base_prediction(const int64_t *plane, int64_t columns, int64_t x, int64_t y) {
  const int64_t *at = plane + y * columns + x;
  const int64_t west = x ? at[-1] : y ? at[-columns] : 0, north = y ? at[-columns] : west;
  return (west + north) >> 1;
}

}  // namespace sgi
