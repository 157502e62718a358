// The search for nearest neighbours, kQueries queries side by side in vectors of doubles.
#pragma once
#include <cstdint>

#include "base/isa.hpp"
#include "model/constants.hpp"

namespace sgi {

constexpr int kRun = 16;     // points of a leaf, boxes of a node
constexpr int kQueries = 8;  // that are answered together: near each other they see the same leaves

// Points in runs, boxes around runs, and boxes around runs of boxes up to one node for all. What fills a last run up is
// infinitely far.
struct PointRuns {
  const double *points;         // [leaves, 2, kRun] x, y
  const double *const *levels;  // level 0: nodes [4, kRun] above leaves, the boxes' x0, y0, x1, y1
  int depth;                    // levels, the last one of a single node
  double unit;                  // a power of two no less than the points
};

// A point's key for a query: its squared distance times `unit`, plus its number. A smaller one is nearer or, as near,
// the earlier point. All are exact: squared distances times unit are below 2^53.
struct NeighbourKernel {
  // keys [kMaxNeighbours, kQueries]: the least of each query, ascending; before, bounds that as many points meet.
  void (*search)(const PointRuns &runs, const double *x, const double *y, double *keys);
  static const NeighbourKernel portable, avx2, avx512;
};

}  // namespace sgi
