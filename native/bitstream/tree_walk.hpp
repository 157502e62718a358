// The tree of seeds level by level and batch by batch (docs/format.md, "Predicted flags"): the one walk that writing,
// reading and training share.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "bitstream/seed_tree.hpp"
#include "bitstream/tree_inputs.hpp"

namespace sgi {

// A picture of width x height pixels and what a prediction sees of it besides the tree.
class TreeScenery {
 public:
  // base [C, rows, columns] in cells of `cell` pixels, 0 for none; the header's quality.
  TreeScenery(int64_t width, int64_t height, const int64_t *base, int64_t channels, int64_t rows, int64_t columns,
              int64_t cell, int quality);

  int64_t width() const { return width_; }
  int64_t height() const { return height_; }
  int quality() const { return quality_; }
  BaseDetail detail() const;

 private:
  int64_t width_, height_, rows_, columns_, cell_;
  int quality_;
  std::vector<int16_t> detail_;  // [rows, columns, kDetail], or none
};

// The split nodes of one level, and four slots for the children of each.
class TreeLevel {
 public:
  // The parents of the roots.
  explicit TreeLevel(const TreeScenery &scenery);
  // The children of `above` that are split, one level further down.
  TreeLevel(const TreeLevel &above, const TreeScenery &scenery);

  int level() const { return level_; }  // of the children
  int64_t parents() const { return int64_t(x_.size()); }
  SplitNodes nodes() const;
  Slots slots() const { return {exists_.data(), flags_.data()}; }

  // Which nodes of a child number are coded, and which must not be empty.
  std::pair<std::vector<int32_t>, std::vector<uint8_t>> batch(int child) const;
  void take(const std::vector<int32_t> &members, int child, const uint8_t *split, const uint8_t *seed);
  // Morton code of a child of a parent.
  int64_t code(int64_t parent, int child) const;
  // Morton codes of the children that carry seeds, ascending.
  std::vector<int64_t> seeds() const;

 private:
  void open(const TreeScenery &scenery);  // makes room for children

  int level_;
  std::vector<int32_t> x_, y_, neighbour_;
  std::vector<int16_t> above_;
  std::vector<uint8_t> exists_, occupied_;  // [P + 1, 4], [P]
  std::vector<int16_t> flags_;              // [P + 1, 4, 2]
};

// Nodes of one level and child number that are coded together.
struct TreeBatch {
  const TreeScenery &scenery;
  const TreeLevel &of;
  int child;
  std::vector<int32_t> members;  // [n] parents
  std::vector<uint8_t> needed;   // [n] which must not be empty, being the last child where the others are
  std::array<int16_t, kHead> head;

  int64_t size() const { return int64_t(members.size()); }
  // What a prediction sees [n, inputs].
  void inputs(int16_t *out) const;
  // As tree_rows; the network is that of the child number.
  void rows(const Network &network, int shift, int most, int threads, int16_t *out) const;
  // The row of every seed flag [n] from rows [n, 3] and split flags [n]; `certain` is that of a flag that is needed.
  void seed_rows(const int16_t *rows, const uint8_t *split, int16_t certain, int16_t *out) const;
};

// Says of each node of a batch whether it is split and whether it carries a seed.
using CodeBatch = std::function<void(const TreeBatch &batch, uint8_t *split, uint8_t *seed)>;

// Goes through a tree and returns its seeds. Throws Error (limit) before it takes memory for more than `most` of them.
std::vector<LevelSeeds> walk_tree(const TreeScenery &scenery, int64_t most, const CodeBatch &code);

}  // namespace sgi
