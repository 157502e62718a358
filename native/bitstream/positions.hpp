// Seeds that are pixels (docs/format.md, "Pixels").
#pragma once
#include "bitstream/seed_tree.hpp"

namespace sgi {

// Throws Error: limit before it takes memory for more than `most` seeds, corrupt for what no encoder wrote.
Seeds read_positions(SymbolReader &reader, int64_t width, int64_t height, int64_t most);

}  // namespace sgi
