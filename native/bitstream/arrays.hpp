// Small integer arrays of a tile: network weights, the base layer, the signs of the hash grid.
#pragma once
#include <cstdint>
#include <vector>

#include "bitstream/symbol_reader.hpp"
#include "bitstream/texture_bits.hpp"

namespace sgi {

// A tensor of `count` integers under one zero-centred table (docs/format.md, "Weights").
std::vector<int64_t> read_weights(SymbolReader &reader, int64_t count);

// Values 0 or 1, level after level, of so many each (docs/format.md, "Grid signs").
std::vector<uint8_t> read_signs(SymbolReader &reader, const std::vector<int64_t> &counts);
BitRecorder write_signs(std::vector<int32_t> signs, const std::vector<int64_t> &counts);

// Planes [channels, rows, columns] (docs/format.md, "Base layer").
std::vector<int64_t> read_base(SymbolReader &reader, int channels, int64_t rows, int64_t columns);

}  // namespace sgi
