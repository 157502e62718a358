// Symbols read in one go: grouped by model as the coder takes them, decoded, and put back.
#pragma once
#include <cstdint>

#include "bitstream/range_decoder.hpp"

namespace sgi {

// The n zero-centred symbols under the tables `keys` [n], escapes included. Throws Error (corrupt).
void read_zero_centred(RangeDecoder &decoder, const int16_t *keys, int64_t n, int32_t *symbols);

}  // namespace sgi
