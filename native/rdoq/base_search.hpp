// The base layer's symbols (docs/format.md, "Base layer"), chosen by squared error, weighted or not, plus price.
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

constexpr int64_t kBaseReach = 3;  // cells farther apart share no pixel

// A step of element (y, x) of a plane adds step times cell y down and cell x across to the picture.
struct BaseFootprint {
  const double *down;    // [rows, rows] inner products of the cells' weights
  const double *across;  // [columns, columns]
  const double *gram;    // [rows, columns, 7, 7] weighted inner products of a cell with those 3 before to 3 behind it,
                         // down and across; nullptr where all weights are 1: then down times across
  double *pull;          // [C, rows, columns] weighted inner products with the residual, kept up to date
  double step;

  // Where the inner products of cell (y, x) with cell (y, x) itself lie in gram.
  const double *own_gram(int64_t y, int64_t x, int64_t columns) const {
    constexpr int64_t kSpan = 2 * kBaseReach + 1;
    return gram + (y * columns + x) * kSpan * kSpan + kBaseReach * kSpan + kBaseReach;
  }
};

// Goes through all elements `passes` times and moves each by one step, or to where the error is least, whichever lowers
// squared error plus `lmbda` per bit most; tables stay. Returns how many moves it made.
int64_t search_base(const BasePlanes &planes, const BaseFootprint &footprint, double lmbda, int passes);

}  // namespace sgi
