// Small integer arrays of a tile: network weights, the base layer, the signs of the hash grid. Each has its size when
// it is read or written (SymbolCoder).
#pragma once
#include <cstdint>
#include <vector>

#include "bitstream/symbol_coder.hpp"

namespace sgi {

// A tensor of integers under the zero-centred table that suits it best (docs/format.md, "Weights").
template <class Coder>
void code_weights(Coder &coder, std::vector<int64_t> &weights);

// Values 0 or 1, level after level, of so many each (docs/format.md, "Grid signs").
template <class Coder>
void code_signs(Coder &coder, const std::vector<int64_t> &counts, std::vector<uint8_t> &signs);

// Planes [channels, rows, columns] (docs/format.md, "Base layer").
template <class Coder>
void code_base(Coder &coder, int channels, int64_t rows, int64_t columns, std::vector<int64_t> &planes);

}  // namespace sgi
