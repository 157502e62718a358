// The seeds of a tile as a quadtree whose nodes say whether they are split and whether they carry a seed
// (docs/format.md, "Tree").
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/symbol_coder.hpp"

namespace sgi {

constexpr int kRootLevel = 6, kMinLevel = 1;  // log2 of the sides of nodes, pixels
constexpr int64_t kMaxRoots = int64_t(1) << 20;

// Corners [N, 2] of their nodes in pixels (x, y), and log2 of the nodes' sides.
struct Seeds {
  std::vector<int32_t> corner;
  std::vector<int8_t> log_size;
};

// What is known of the nodes of a tile, level by level: planes with a border of nodes that are not there. A level takes
// memory from when it is opened on.
class TreeNodes {
 public:
  static constexpr uint8_t kSeed = 1, kSplit = 2;

  TreeNodes(int64_t width, int64_t height) : width_(width), height_(height) {}

  // Bytes of all levels of a tile.
  static int64_t memory(int64_t width, int64_t height);

  void open(int level) { planes_[size_t(level)].resize(size_t(stride(level) * (rows(level) + 2))); }
  int64_t columns(int level) const { return ((width_ - 1) >> level) + 1; }
  int64_t rows(int level) const { return ((height_ - 1) >> level) + 1; }
  uint8_t &at(int level, int64_t x, int64_t y) { return planes_[size_t(level)][index(level, x, y)]; }
  uint8_t at(int level, int64_t x, int64_t y) const { return planes_[size_t(level)][index(level, x, y)]; }

 private:
  int64_t stride(int level) const { return columns(level) + 2; }
  size_t index(int level, int64_t x, int64_t y) const { return size_t((y + 1) * stride(level) + x + 1); }

  int64_t width_, height_;
  std::array<std::vector<uint8_t>, kRootLevel + 2> planes_;  // that of the roots' parents is the last
};

// The tree of some seeds. Throws Error: limit for more than `most` seeds, usage for seeds that are no nodes of a tree
// of this size, or share one.
template <class Coder>
void code_tree(Coder &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds);

}  // namespace sgi
