// The tree of given seeds, for writing and training.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/tree_walk.hpp"

namespace sgi {

class GivenTree {
 public:
  // Throws Error (usage) for seeds that are no nodes of a tree of this size, or share one.
  GivenTree(const TreeScenery &scenery, const int32_t *corner, const int8_t *log_size, int64_t count);

  int64_t count() const { return count_; }
  // Whether the nodes of a batch [n] are split, or else carry seeds.
  void fill(const TreeBatch &batch, bool is_split, uint8_t *flags) const;

 private:
  using Levels = std::array<std::vector<int64_t>, kRootLevel + 1>;  // ascending

  int64_t count_;
  Levels seeds_, splits_;
};

}  // namespace sgi
