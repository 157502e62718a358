// The base layer's symbols (docs/format.md, "Base layer"), chosen by squared error plus price.
#pragma once
#include <cstdint>

#include "rdoq/coding.hpp"

namespace sgi {

// Planes [C, rows, columns] and how they are coded.
struct BasePlanes {
  int64_t *values;
  int64_t channels, rows, columns;
  const int32_t *table;  // [C]
  SymbolBits tables;     // `first` is 0
};

// A step of element (y, x) of a plane adds step times cell y down and cell x across to the picture.
struct BaseFootprint {
  const double *down;    // [rows, rows] inner products of the cells' weights
  const double *across;  // [columns, columns]
  double *pull;          // [C, rows, columns] inner products with the residual, kept up to date
  double step;
};

// Goes through all elements `passes` times and moves each by one step, or to where the error is least, whichever lowers
// squared error plus `lmbda` per bit most; tables stay. Returns how many moves it made.
int64_t search_base(const BasePlanes &planes, const BaseFootprint &footprint, double lmbda, int passes);

}  // namespace sgi
