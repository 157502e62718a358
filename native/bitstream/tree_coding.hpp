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

  // Codes the nodes of a level row by row; visit(x, y, node) after each. False where `bits` has none.
  template <class Visit>
  bool level(int level, Visit visit) {
    nodes_.open(level);
    for (int64_t y = 0; y < nodes_.rows(level); ++y)
      for (int64_t x = 0; x < nodes_.columns(level); ++x) {
        if (!(nodes_.at(level + 1, x >> 1, y >> 1) & TreeNodes::kSplit)) {
          x |= 1;  // nor is there a sibling beside it
          continue;
        }
        if (!node(level, x, y)) return false;
        visit(x, y, nodes_.at(level, x, y));
      }
    return true;
  }

  std::vector<int32_t> flags;  // that were coded

 private:
  enum Flag : uint32_t { kSplitFlag, kLeafSeed, kSplitSeed, kFlags };
  static constexpr uint32_t kKinds = kRootLevel * kFlags;
  static constexpr std::array<uint32_t, 4> kContexts{64, 144, 8, 160};  // of each kind of flag; and one of all
  static constexpr uint32_t kModels = kKinds * (kContexts[0] + kContexts[1] + kContexts[2] + kContexts[3] + 1);

  // What is known before the flags of a node are coded.
  struct Surroundings {
    uint32_t split = 0, seeds = 0;  // of the nodes to the left, above, above to the left and to the right, a bit each
    uint32_t child;                 // its number
    bool is_occupied, is_last;      // whether an earlier sibling is, and whether no sibling follows
    uint32_t parents;               // what the parent and those around it add to the models
    uint32_t beside;                // the same of those on its own side, and of the parent's parent
  };

  bool node(int level, int64_t x, int64_t y) {
    const Surroundings around = surroundings(level, x, y);
    const uint8_t truth = given_ ? given_->at(level, x, y) : uint8_t(0);
    int split = (truth & TreeNodes::kSplit) != 0, seed = (truth & TreeNodes::kSeed) != 0;
    if (level > kMinLevel && !flag(level, kSplitFlag, around, split)) return false;
    const bool is_certain = level < kRootLevel && !split && around.is_last && !around.is_occupied;
    if (is_certain) seed = 1;
    if (!is_certain && !flag(level, split ? kSplitSeed : kLeafSeed, around, seed)) return false;
    nodes_.at(level, x, y) = uint8_t(split * TreeNodes::kSplit + seed * TreeNodes::kSeed);
    return true;
  }

  bool flag(int level, Flag which, const Surroundings &around, int &value) {
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
    if (!code_bit(bits_, models, kQuick, value)) return false;
    flags.push_back(value);
    return true;
  }

  Surroundings surroundings(int level, int64_t x, int64_t y) const {
    Surroundings around;
    const auto split = [&](int up, int64_t dx, int64_t dy) {
      return uint32_t(nodes_.at(level + up, (x >> up) + dx, (y >> up) + dy) >> 1);
    };
    const auto seed = [&](int up, int64_t dx, int64_t dy) {
      return uint32_t(nodes_.at(level + up, (x >> up) + dx, (y >> up) + dy) & TreeNodes::kSeed);
    };
    constexpr int kKnownX[4] = {-1, 0, -1, 1}, kKnownY[4] = {0, -1, -1, -1};
    for (int i = 0; i < 4; ++i) {
      around.split |= split(0, kKnownX[i], kKnownY[i]) << i;
      around.seeds |= seed(0, kKnownX[i], kKnownY[i]) << i;
    }
    const int right = int(x & 1), below = int(y & 1);
    around.child = uint32_t(right + 2 * below);
    constexpr uint32_t kSiblings[4] = {0, 1, 2 + 8, 1 + 2 + 4};  // which of those four are
    around.is_occupied = ((around.split | around.seeds) & kSiblings[around.child]) != 0;
    around.is_last = (right || x + 1 == nodes_.columns(level)) && (below || y + 1 == nodes_.rows(level));
    uint32_t splits = 0, seeds = 0, above = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        splits += split(1, dx, dy), seeds += seed(1, dx, dy);
        if (level < kRootLevel) above += split(2, dx, dy);
      }
    around.parents = (splits - split(1, 0, 0)) * 4 + std::min(3u, seeds - seed(1, 0, 0));
    const int dx = right ? 1 : -1, dy = below ? 1 : -1;
    around.beside = (((split(1, dx, 0) * 2 + split(1, 0, dy)) * 2 + split(1, dx, dy)) * 2 + seed(1, 0, 0)) * 10 + above;
    return around;
  }

  Bits &bits_;
  TreeNodes &nodes_;
  const TreeNodes *given_;
  std::vector<BitModel> models_ = std::vector<BitModel>(kModels);
};

}  // namespace sgi
