// The order in which a tree of seeds is coded, for writers and readers alike (docs/format.md, "Tree").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/bit_model.hpp"
#include "bitstream/seed_tree.hpp"

namespace sgi {

template <class Bits>
class TreeCoding {
 public:
  // given: the tree to write, null when reading. The roots' parents count as split.
  TreeCoding(Bits &bits, TreeNodes &nodes, const TreeNodes *given) : bits_(bits), nodes_(nodes), given_(given) {
    constexpr int kAbove = kRootLevel + 1;
    nodes.open(kAbove);
    for (int64_t y = 0; y < nodes.rows(kAbove); ++y)
      for (int64_t x = 0; x < nodes.columns(kAbove); ++x) nodes.at(kAbove, x, y) = TreeNodes::kSplit;
  }

  // Codes the nodes of a level row by row; visit(node) after each.
  template <class Visit>
  void level(int level, Visit visit) {
    nodes_.open(level);
    parents_.resize(size_t(nodes_.columns(level + 1)));
    for (int64_t y = 0; y < nodes_.rows(level); ++y)
      for (int64_t left = 0; left < nodes_.columns(level); left += 2) {
        if (!(nodes_.at(level + 1, left >> 1, y >> 1) & TreeNodes::kSplit)) continue;
        Parent &parent = parents_[size_t(left >> 1)];
        if (y % 2 == 0) parent = parent_at(level + 1, left >> 1, y >> 1);
        for (int64_t x = left; x < std::min(left + 2, nodes_.columns(level)); ++x) {
          node(level, x, y, parent);
          visit(nodes_.at(level, x, y));
        }
      }
  }

  std::vector<int32_t> flags;  // that were coded

 private:
  enum Flag : uint32_t { kSplitFlag, kLeafSeed, kSplitSeed, kFlags };
  static constexpr uint32_t kKinds = kRootLevel * kFlags;
  static constexpr std::array<uint32_t, 4> kContexts{64, 144, 8, 160};  // of each kind of flag; and one of all
  static constexpr uint32_t kModels = kKinds * (kContexts[0] + kContexts[1] + kContexts[2] + kContexts[3] + 1);

  // What a node's parent and those around it tell.
  struct Parent {
    std::array<uint8_t, 9> split;  // which of these are, row by row
    uint32_t seed, above, sums;    // of itself; how many nodes around its own parent are split; of those around
  };

  // What is known before the flags of a node are coded.
  struct Surroundings {
    uint32_t split = 0, seeds = 0;  // of the nodes to the left, above, above to the left and to the right, a bit each
    uint32_t child;                 // its number
    bool is_occupied, is_last;      // whether an earlier sibling is, and whether no sibling follows
    uint32_t parents;               // what the parent and those around it add to the models
    uint32_t beside;                // the same of those on its own side, and of the parent's parent
  };

  void node(int level, int64_t x, int64_t y, const Parent &parent) {
    const Surroundings around = surroundings(level, x, y, parent);
    const uint8_t truth = given_ ? given_->at(level, x, y) : uint8_t(0);
    int split = (truth & TreeNodes::kSplit) != 0, seed = (truth & TreeNodes::kSeed) != 0;
    if (level > kMinLevel) flag(level, kSplitFlag, around, split);
    const bool is_certain = level < kRootLevel && !split && around.is_last && !around.is_occupied;
    if (is_certain)
      seed = 1;
    else
      flag(level, split ? kSplitSeed : kLeafSeed, around, seed);
    nodes_.at(level, x, y) = uint8_t(split * TreeNodes::kSplit + seed * TreeNodes::kSeed);
  }

  void flag(int level, Flag which, const Surroundings &around, int &value) {
    const uint32_t kind = uint32_t(level - kMinLevel) * kFlags + which;
    const uint32_t alike = which == kSplitFlag ? around.split : around.seeds;
    const uint32_t others = which == kSplitFlag ? around.seeds : around.split;
    const std::array<uint32_t, kContexts.size()> within{alike * 4 + std::min(3, __builtin_popcount(others)),
                                                        around.parents * 4 + around.child,
                                                        uint32_t(around.is_occupied) * 4 + around.child, around.beside};
    std::array<BitModel *, kContexts.size() + 1> models;
    uint32_t first = 0;
    for (size_t i = 0; i < within.size(); first += kKinds * kContexts[i++])
      models[i] = &models_[first + kind * kContexts[i] + within[i]];
    models.back() = &models_[first + kind];
    code_bit(bits_, models, kQuick, value);
    flags.push_back(value);
  }

  Parent parent_at(int level, int64_t x, int64_t y) const {
    Parent parent{{}, uint32_t(nodes_.at(level, x, y) & TreeNodes::kSeed), 0, 0};
    uint32_t splits = 0, seeds = 0;
    size_t i = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const uint8_t node = nodes_.at(level, x + dx, y + dy);
        splits += parent.split[i++] = uint8_t(node >> 1);
        seeds += node & TreeNodes::kSeed;
        if (level <= kRootLevel) parent.above += nodes_.at(level + 1, (x >> 1) + dx, (y >> 1) + dy) >> 1;
      }
    parent.sums = (splits - 1) * 4 + std::min(3u, seeds - parent.seed);  // it is split itself
    return parent;
  }

  Surroundings surroundings(int level, int64_t x, int64_t y, const Parent &parent) const {
    Surroundings around;
    constexpr int kKnownX[4] = {-1, 0, -1, 1}, kKnownY[4] = {0, -1, -1, -1};
    for (int i = 0; i < 4; ++i) {
      const uint32_t node = nodes_.at(level, x + kKnownX[i], y + kKnownY[i]);
      around.split |= (node >> 1) << i, around.seeds |= (node & TreeNodes::kSeed) << i;
    }
    const int right = int(x & 1), below = int(y & 1);
    around.child = uint32_t(right + 2 * below);
    constexpr uint32_t kSiblings[4] = {0, 1, 2 + 8, 1 + 2 + 4};  // which of those four are
    around.is_occupied = ((around.split | around.seeds) & kSiblings[around.child]) != 0;
    around.is_last = (right || x + 1 == nodes_.columns(level)) && (below || y + 1 == nodes_.rows(level));
    around.parents = parent.sums;
    const int beside = 4 + (right ? 1 : -1), over = 4 + (below ? 3 : -3), across = beside + over - 4;
    const auto split = [&](int place) { return uint32_t(parent.split[size_t(place)]); };
    around.beside = (((split(beside) * 2 + split(over)) * 2 + split(across)) * 2 + parent.seed) * 10 + parent.above;
    return around;
  }

  Bits &bits_;
  TreeNodes &nodes_;
  const TreeNodes *given_;
  std::vector<Parent> parents_;  // of the row that is coded, where they are split
  std::vector<BitModel> models_ = std::vector<BitModel>(kModels);
};

}  // namespace sgi
