// One pass of coordinate descent over many seeds, in place. Errors are weighted where the residual has weights.
#pragma once
#include <cstdint>

#include "bitstream/attributes.hpp"
#include "rdoq/seed_search.hpp"

namespace sgi {

// What is chosen of N seeds, d = C + 5 attributes each.
struct FoundSeeds {
  int64_t *decoded;  // [N, d] units of 2^-24
  double *change;    // [N] of squared error, plus the price of the seed's bits
};

// Searches all seeds pass by pass, each with the others as they are by then; within a pass in an order of its own. No
// result depends on the threads. values [N, d]: as rendered now.
void search_seeds(const TileSeeds &seeds, const CodingModel &model, const SearchSettings &settings,
                  const Residual &residual, const double *values, const FoundSeeds &out, int threads);

}  // namespace sgi
