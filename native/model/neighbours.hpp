// Nearest neighbours among integer points: exact, so that encoder and decoder always agree.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

// Of points [N, 2], for each of `members` [m] its k nearest among `among` [n] by squared distance, nearest first, ties
// to the one that comes first in `among`; -1 where there are fewer than k. All are indices of points, out [m, k] too.
void nearest_among(const int32_t *points, const int64_t *among, int64_t n, const int64_t *members, int64_t m, int k,
                   Isa isa, int32_t *out);

}  // namespace sgi
