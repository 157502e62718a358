// Categorical symbols read in one go: grouped by model as the coder takes them, decoded, and put back.
#pragma once
#include <cstdint>

#include "range_decoder.hpp"

namespace sgi {

// Alphabets of `size` symbols each: what reads them, which symbol each index is and its information content.
struct Alphabets {
  const SymbolModels *models;  // [rows]
  const int32_t *symbol;       // [rows, size]
  const double *bits;          // [rows, size]
  int64_t size;
};

// The n symbols under the alphabets `keys` [n]; adds their information content to `bits`. False where the payload does
// not decode.
bool read_categorical(RangeDecoder &decoder, const Alphabets &alphabets, const int16_t *keys, int64_t n, int32_t *symbols,
                      double &bits);

}  // namespace sgi
