// A quadtree of seeds: its shape, and the seeds that were found in it.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

namespace sgi {

constexpr int kTreeRoot = 6;  // log2 of the side of a tile's roots, pixels
constexpr int64_t kMaxRoots = int64_t(1) << 20;

// A picture of width x height pixels under nodes of 2^min_log to 2^root_log.
struct TreeShape {
  int64_t width, height;
  int root_log, min_log;

  int64_t columns() const { return (width + (int64_t(1) << root_log) - 1) >> root_log; }
  int64_t rows() const { return (height + (int64_t(1) << root_log) - 1) >> root_log; }
};

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
