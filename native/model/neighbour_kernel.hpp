// The search for nearest neighbours, kQueries queries side by side in vectors of 32-bit integers.
#pragma once
#include <cstdint>

#include "base/isa.hpp"
#include "model/constants.hpp"

namespace sgi {

constexpr int kRun = 16;                      // points of a leaf, boxes of a node
constexpr int kQueries = 16;                  // that are answered together: near each other they see the same leaves
constexpr int32_t kFar = 32767;               // a coordinate of what fills a last run up
constexpr int32_t kMaxCoordinate = kFar / 2;  // of points and queries, 0 or more: kFar is farther than any

// Two coordinates as one number.
inline int32_t packed(int32_t x, int32_t y) { return int32_t(uint32_t(x) | uint32_t(y) << 16); }

// Points in runs, boxes around runs, and boxes around runs of boxes up to one node for all.
struct PointRuns {
  const int32_t *points;         // [leaves, kRun], packed
  const int32_t *const *levels;  // level 0: nodes [4, kRun] above leaves, the boxes' x0, y0, x1, y1
  int depth;                     // levels, the last one of a single node
  int number_bits;               // of a point, what fills a run up included: at least four

  // The square of a distance that a key can say at most, which stands for all larger ones, that of kFar too.
  int32_t max_square() const { return INT32_MAX >> number_bits; }
};

// A point's key for a query: its squared distance, at most max_square(), and in lower bits its number. A smaller one is
// nearer or, as near, the earlier point.
struct NeighbourKernel {
  // x, y [kQueries]; keys [kMaxNeighbours, kQueries]: the least of each query, ascending; before, bounds that as many
  // points meet. One of max_square() says nothing of which points there are.
  void (*search)(const PointRuns &runs, const int32_t *x, const int32_t *y, int32_t *keys);
  static const NeighbourKernel portable, avx2, avx512;
};

}  // namespace sgi
