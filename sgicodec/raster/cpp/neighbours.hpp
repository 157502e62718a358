// Nearest neighbours among integer points: exact, so that encoder and decoder always agree.
#pragma once
#include <cstdint>

namespace sgi {

// For every query the indices of its k nearest points by squared distance, nearest first, ties to the lower index;
// -1 where there are fewer than k points. points [n, 2], queries [m, 2], out [m, k].
void nearest_neighbours(const int32_t *points, int64_t n, const int32_t *queries, int64_t m, int k, int threads,
                        int32_t *out);

// The same among some of all points: `among` [n] and `members` [m] are indices of the points to find and of the queries,
// out [m, k] indices of all points.
void nearest_among(const int32_t *points, const int64_t *among, int64_t n, const int64_t *members, int64_t m, int k,
                   int threads, int32_t *out);

}  // namespace sgi
