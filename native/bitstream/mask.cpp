#include "bitstream/mask.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "base/error.hpp"
#include "bitstream/symbol_reader.hpp"

namespace sgi {
namespace {

// Mixed nodes of a mask, about 80 bytes each: as many as any mask of 1.1 megapixels has, and more for each byte. An
// outline, or noise, has three for each byte; a mixed node of four pixels takes a bit at least.
constexpr int64_t kMaxNodes = 3 << 17, kNodesPerByte = 32;
constexpr uint8_t kMixed = 2, kNoNode = 3;  // states besides 0 and 1
constexpr int kContexts = 81;
// Of the left, right, upper, lower neighbour: the axis (0 across, 1 down), and what a child's number changes by.
constexpr int kAxis[4] = {0, 0, 1, 1}, kStep[4] = {1, 1, 2, 2};

// Whether the neighbour of a child on a side has the same parent; it is child number `child ^ kStep[side]` of its own.
bool has_same_parent(int child, int side) { return (child >> kAxis[side] & 1) != side % 2; }

struct MixedNode {
  int64_t x, y;
  std::array<int32_t, 4> near;  // links to the neighbours
};

using States = std::vector<std::array<uint8_t, 4>>;
using Links = std::vector<int32_t>;

// How often each state occurred in each context [81, kinds].
class Counts {
 public:
  explicit Counts(int kinds) : kinds_(kinds), counts_(size_t(kContexts * kinds)) {}

  // Integers that sum to 2^24 in every row, in proportion to 1 + 2 count.
  Alphabets alphabets() const {
    std::vector<int64_t> frequencies;
    for (size_t row = 0; row < counts_.size(); row += size_t(kinds_)) {
      int64_t weights = 0, sum = 0;
      for (int s = 0; s < kinds_; ++s) weights += 1 + 2 * counts_[row + size_t(s)];
      for (int s = 0; s < kinds_; ++s) {
        frequencies.push_back(1 + (kTotalFrequency - kinds_) * (1 + 2 * counts_[row + size_t(s)]) / weights);
        sum += frequencies.back();
      }
      frequencies[row] += kTotalFrequency - sum;
    }
    return {frequencies, kinds_};
  }

  void add(int16_t context, int32_t state) { ++counts_[size_t(context) * size_t(kinds_) + size_t(state)]; }

 private:
  int kinds_;
  std::vector<int64_t> counts_;
};

class MaskReader {
 public:
  MaskReader(Bytes payload, int64_t width, int64_t height)
      : reader_(payload), width_(width), height_(height), left_(kMaxNodes + kNodesPerByte * int64_t(payload.size)) {}

  std::vector<Links> read() {
    int top = 0;
    while (std::max({width_ - 1, height_ - 1, int64_t(1)}) >> top) ++top;
    std::vector<MixedNode> nodes{{0, 0, {MaskTree::kBeyond, MaskTree::kBeyond, MaskTree::kBeyond, MaskTree::kBeyond}}};
    Counts inner(3), bottom(2);
    std::vector<Links> levels;
    for (int level = top - 1; level >= 0; --level) {
      const int64_t side = int64_t(1) << level;
      columns_ = (width_ + side - 1) >> level, rows_ = (height_ + side - 1) >> level;
      levels.push_back(links_of(read_level(nodes, level ? inner : bottom), nodes));
    }
    reader_.finish();
    return levels;
  }

 private:
  bool is_inside(const MixedNode &node, int child) const {
    return 2 * node.x + (child & 1) < columns_ && 2 * node.y + (child >> 1) < rows_;
  }

  // The states of the children of mixed nodes.
  States read_level(const std::vector<MixedNode> &nodes, Counts &counts) {
    States states(nodes.size(), {kMixed, kMixed, kMixed, kMixed});
    std::vector<size_t> inside;
    std::vector<int16_t> contexts;
    std::vector<int32_t> coded;
    for (int child = 0; child < 4; ++child) {
      inside.clear(), contexts.clear();
      for (size_t i = 0; i < nodes.size(); ++i) {
        if (!is_inside(nodes[i], child)) continue;
        int context = 0;
        for (int side = 0; side < 4; ++side) context = 3 * context + state_beside(states, nodes, i, child, side);
        inside.push_back(i), contexts.push_back(int16_t(context));
      }
      coded.resize(inside.size());
      reader_.categorical(counts.alphabets().view(), contexts.data(), int64_t(contexts.size()), coded.data());
      for (size_t i = 0; i < inside.size(); ++i) {
        counts.add(contexts[i], coded[i]);
        states[inside[i]][size_t(child)] = uint8_t(coded[i]);
        left_ -= coded[i] == kMixed;
      }
      if (left_ < 0)
        throw Error(Fault::limit, "a mask of too many nodes for its length: more than " + std::to_string(kMaxNodes) +
                                      "; it is refused");
    }
    for (size_t i = 0; i < nodes.size(); ++i)
      for (int child = 0; child < 4; ++child)
        if (!is_inside(nodes[i], child)) states[i][size_t(child)] = kNoNode;
    return states;
  }

  // What is known of the neighbour of a child: beyond the edge it is the node's own, mixed.
  static int state_beside(const States &states, const std::vector<MixedNode> &nodes, size_t node, int child, int side) {
    const auto other = size_t(child ^ kStep[side]);
    if (has_same_parent(child, side)) return states[node][other];
    const int32_t link = nodes[node].near[size_t(side)];
    if (link >= 0) return states[size_t(link)][other];
    return link == MaskTree::kSet ? 1 : link == MaskTree::kClear ? 0 : kMixed;
  }

  // The links to the children. `nodes` become the mixed ones among them, row by row.
  static Links links_of(const States &states, std::vector<MixedNode> &nodes) {
    constexpr int32_t kLinks[4] = {MaskTree::kClear, MaskTree::kSet, 0, MaskTree::kBeyond};
    Links links(4 * nodes.size());
    std::vector<size_t> mixed;  // 4 node + child
    for (size_t first = 0, last; first < nodes.size(); first = last) {
      for (last = first; last < nodes.size() && nodes[last].y == nodes[first].y;) ++last;
      for (size_t down = 0; down < 2; ++down)
        for (size_t slot = 4 * first; slot < 4 * last; ++slot) {
          if ((slot >> 1 & 1) != down) continue;
          const uint8_t state = states[slot >> 2][slot & 3];
          links[slot] = state == kMixed ? int32_t(mixed.size()) : kLinks[state];
          if (state == kMixed) mixed.push_back(slot);
        }
    }
    std::vector<MixedNode> children;
    children.reserve(mixed.size());
    for (const size_t slot : mixed) {
      const MixedNode &node = nodes[slot >> 2];
      const int child = int(slot & 3);
      MixedNode next{2 * node.x + (child & 1), 2 * node.y + (child >> 1), {}};
      for (int side = 0; side < 4; ++side) {
        const int32_t parent = has_same_parent(child, side) ? int32_t(slot >> 2) : node.near[size_t(side)];
        next.near[size_t(side)] = parent >= 0 ? links[4 * size_t(parent) + size_t(child ^ kStep[side])] : parent;
      }
      children.push_back(next);
    }
    nodes = std::move(children);
    return links;
  }

  SymbolReader reader_;
  int64_t width_, height_, left_;   // mixed nodes that may still come
  int64_t columns_ = 0, rows_ = 0;  // of the level that is read
};

// Rows and columns of pixels, ascending, and where the mask goes.
struct Sampling {
  const std::vector<Links> &levels;
  const int64_t *x, *y;
  int64_t columns;
  uint8_t *out;

  // Below a mixed node at (left, top) of its level: the pixels y[rows.first ...], x[columns.first ...].
  void fill(size_t level, int32_t node, int64_t left, int64_t top, std::pair<int64_t, int64_t> rows_of,
            std::pair<int64_t, int64_t> columns_of) const {
    const int shift = int(levels.size() - 1 - level);
    const int64_t row = std::lower_bound(y + rows_of.first, y + rows_of.second, (2 * top + 1) << shift) - y;
    const int64_t column = std::lower_bound(x + columns_of.first, x + columns_of.second, (2 * left + 1) << shift) - x;
    for (int child = 0; child < 4; ++child) {
      const auto rows = child >> 1 ? std::pair{row, rows_of.second} : std::pair{rows_of.first, row};
      const auto across = child & 1 ? std::pair{column, columns_of.second} : std::pair{columns_of.first, column};
      const int32_t link = levels[level][4 * size_t(node) + size_t(child)];
      if (rows.first == rows.second || across.first == across.second) continue;
      if (link >= 0) fill(level + 1, link, 2 * left + (child & 1), 2 * top + (child >> 1), rows, across);
      if (link == MaskTree::kSet)
        for (int64_t r = rows.first; r < rows.second; ++r)
          std::fill(out + r * columns + across.first, out + r * columns + across.second, uint8_t(1));
    }
  }
};

}  // namespace

MaskTree MaskTree::read(Bytes payload, int64_t width, int64_t height) {
  MaskTree tree(width, height);
  tree.levels_ = MaskReader(payload, width, height).read();
  return tree;
}

bool MaskTree::is_mixed() const {
  const auto has = [&](int32_t link) {
    return std::any_of(levels_.begin(), levels_.end(),
                       [&](const Links &links) { return std::find(links.begin(), links.end(), link) != links.end(); });
  };
  return has(kClear) && has(kSet);
}

void MaskTree::sample(const int64_t *x, int64_t columns, const int64_t *y, int64_t rows, uint8_t *out) const {
  std::fill_n(out, rows * columns, uint8_t(levels_.empty()));
  if (!levels_.empty()) Sampling{levels_, x, y, columns, out}.fill(0, 0, 0, 0, {0, rows}, {0, columns});
}

int64_t MaskTree::memory() const {
  int64_t bytes = 0;
  for (const Links &links : levels_) bytes += int64_t(links.size() * sizeof(int32_t));
  return bytes;
}

}  // namespace sgi
