// One pass of coordinate descent over many seeds, in place; and pruning. Errors are weighted where the residual has
// weights.
#pragma once
#include <cstdint>

#include "rdoq/seed_search.hpp"

namespace sgi {

// n seeds of one coding group, d = C + 5 attributes each.
struct SeedArrays {
  int64_t count;
  const int16_t *inputs;  // [n, stride] of the first network
  int64_t stride;
  const double *values;    // [n, d] as rendered now
  const float *centre;     // [n, 2] pixels
  const float *cell;       // [n] pixels
  const int8_t *log_size;  // [n]
};

struct SymbolArrays {
  int64_t *decoded;  // [n, d] units of 2^-24
  int32_t *symbols;  // [n, d]
  int16_t *scale;    // [n, d] scale indices of their tables
  double *change;    // [n] of squared error, plus the price of the seed's bits
};

// Searches every seed, one after the other in an order of its own; no result depends on the threads.
void search_seeds(const CodingModel &model, const SearchSettings &settings, const Residual &residual,
                  const SeedArrays &seeds, const SymbolArrays &out, int threads, Isa isa);

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
