// The flags of a tree of seeds and the probabilities that a shipped network predicts (docs/format.md, "Predicted
// flags"): what reading and writing share.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "base/isa.hpp"
#include "bitstream/tree_walk.hpp"

namespace sgi {

// Frequencies [rows, 2] of flags: rows of log-odds -6 ... 6, then that of a flag that is 1 in any case.
std::vector<int64_t> flag_frequencies();

// Says whether the nodes of a batch [n] are split, or else carry seeds. rows: those of the flags' frequencies.
using CodeFlags =
    std::function<void(const TreeBatch &batch, bool is_split, const std::vector<int16_t> &rows, uint8_t *flags)>;

// Goes through a tree and returns its seeds. Throws Error as walk_tree does.
std::vector<LevelSeeds> code_flags(const TreeScenery &scenery, int64_t most, int threads, Isa isa,
                                   const CodeFlags &code);

}  // namespace sgi
