// One pass of coordinate descent over many seeds, in place; and pruning. Errors are weighted where the residual has
// weights.
#pragma once
#include <cstdint>

#include "bitstream/attributes.hpp"
#include "rdoq/seed_search.hpp"

namespace sgi {

// What is chosen of N seeds, d = C + 5 attributes each.
struct SymbolArrays {
  int64_t *decoded;  // [N, d] units of 2^-24
  int32_t *symbols;  // [N, d]
  int16_t *scale;    // [N, d] scale indices of their tables
  double *change;    // [N] of squared error, plus the price of the seed's bits
};

// Searches all seeds pass by pass, each with the others as they are by then; within a pass in an order of its own. No
// result depends on the threads. coding: that of plain seeds, which `model` prices; values [N, d]: as rendered now.
void search_seeds(const AttributeModel &coding, const TileSeeds &seeds, const CodingModel &model,
                  const SearchSettings &settings, const Residual &residual, const double *values,
                  const SymbolArrays &out, int threads);

// n Gaussians that may be left out.
struct Prunable {
  const float *means;        // [n, 2] pixels
  const float *covariances;  // [n, 3] pixels^2
  const float *colours;      // [n, C]
  const float *price;        // [n] squared error that leaving it out may cost
  int64_t count;
};

// Leaves out, one after the other, what costs less squared error than its price, and takes it out of the picture before
// the next is looked at. Sets pruned [n].
void prune_gaussians(const Residual &residual, const Prunable &gaussians, float cutoff, int threads, Isa isa,
                     bool *pruned);

}  // namespace sgi
