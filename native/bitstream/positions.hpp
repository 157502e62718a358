// The seeds of a tile: a quadtree under probabilities that a shipped network predicts (docs/format.md, "Seed
// positions"), or pixels ("Pixels"). Both throw Error: limit before they take memory for more than `most` seeds,
// corrupt for what no encoder wrote.
#pragma once
#include "base/isa.hpp"
#include "bitstream/seed_tree.hpp"
#include "bitstream/symbol_reader.hpp"
#include "bitstream/tree_walk.hpp"

namespace sgi {

Seeds read_positions(SymbolReader &reader, int64_t width, int64_t height, int64_t most);

Seeds read_predicted_positions(SymbolReader &reader, const TreeScenery &scenery, int64_t most, int threads, Isa isa);

}  // namespace sgi
