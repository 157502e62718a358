// The seeds of a tile: a quadtree under probabilities that the stream states (docs/format.md, "Seed positions"), or
// under those that a shipped network predicts ("Predicted flags"). Both throw Error: limit before they take memory for
// more than `most` seeds, corrupt for a tree that no encoder wrote.
#pragma once
#include <memory>

#include "base/isa.hpp"
#include "bitstream/seed_tree.hpp"
#include "bitstream/symbol_reader.hpp"
#include "bitstream/tree_walk.hpp"

namespace sgi {

Seeds read_positions(SymbolReader &reader, const TreeShape &shape, int64_t most);

// Trees of kRootLevel to kLeastLevel.
Seeds read_predicted_positions(SymbolReader &reader, std::shared_ptr<const TreeScenery> scenery, int64_t most,
                               int threads, Isa isa);

}  // namespace sgi
