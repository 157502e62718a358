// Seeds that are pixels (docs/format.md, "Pixels").
#pragma once
#include "bitstream/seed_tree.hpp"

namespace sgi {

// Throws Error: limit before it takes memory for more than `most` seeds, corrupt for what no encoder wrote, usage for
// seeds that are no pixels of the tile, or share one.
template <class Coder>
void code_positions(Coder &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds);

}  // namespace sgi
