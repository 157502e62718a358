// A quadtree of seeds: its levels, and the seeds that were found in it.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

namespace sgi {

constexpr int kRootLevel = 6, kMinLevel = 1;  // log2 of the sides of nodes, pixels
constexpr int64_t kMaxRoots = int64_t(1) << 20;

// Corners [N, 2] of their nodes in pixels (x, y), and log2 of the nodes' sides.
struct Seeds {
  std::vector<int32_t> corner;
  std::vector<int8_t> log_size;
};

// Morton codes of the nodes of a level that carry seeds, ascending.
using LevelSeeds = std::pair<int, std::vector<int64_t>>;

// All of them in the format's order: by the Morton order of corners, coarse before fine where they coincide.
Seeds seeds_of(const std::vector<LevelSeeds> &found);

}  // namespace sgi
