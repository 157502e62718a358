// Symbols read in one go: grouped by model as the coder takes them, decoded, and put back.
#pragma once
#include <cstdint>

#include "bitstream/range_decoder.hpp"

namespace sgi {

// Zero-centred tables, and what reads the exponents behind an escape.
struct ZeroCentred {
  const SymbolModels *models;
  const int32_t *support;  // of each table: symbols from -support to support, and an escape
  const SymbolModels *exponents;
  int32_t most;  // the largest magnitude
};

enum class Reading { kSound, kDamaged, kTooLarge };

// The n symbols under the tables `keys` [n].
Reading read_zero_centred(RangeDecoder &decoder, const ZeroCentred &models, const int16_t *keys, int64_t n,
                          int32_t *symbols);

}  // namespace sgi
