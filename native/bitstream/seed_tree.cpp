#include "bitstream/seed_tree.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "bitstream/tree_coding.hpp"

namespace sgi {
namespace {

Error misplaced(const char *text) { return Error(Fault::usage, std::string("positions: ") + text); }

// The tree of seeds.
TreeNodes tree_of(int64_t width, int64_t height, const Seeds &seeds) {
  TreeNodes tree(width, height);
  for (int level = kMinLevel; level <= kRootLevel; ++level) tree.open(level);
  for (size_t i = 0; i < seeds.log_size.size(); ++i) {
    const int64_t x = seeds.corner[2 * i], y = seeds.corner[2 * i + 1];
    const int level = seeds.log_size[i];
    if (level < kMinLevel || level > kRootLevel || x < 0 || y < 0 || x >= width || y >= height ||
        (x | y) & ((1 << level) - 1))
      throw misplaced("a seed is no node of the tree: outside, off its grid, of another size");
    uint8_t &node = tree.at(level, x >> level, y >> level);
    if (node & TreeNodes::kSeed) throw misplaced("two seeds share one node");
    node |= TreeNodes::kSeed;
    for (int above = level + 1; above <= kRootLevel; ++above)
      tree.at(above, x >> above, y >> above) |= TreeNodes::kSplit;
  }
  return tree;
}

// Adds the seeds of a node and below, which have the format's order so: by the Morton order of corners, coarse before
// fine where they coincide. Above the roots all is split.
void add_seeds(const TreeNodes &nodes, int level, int64_t x, int64_t y, Seeds &seeds) {
  if (x >= nodes.columns(level) || y >= nodes.rows(level)) return;
  const uint8_t node = level > kRootLevel ? TreeNodes::kSplit : nodes.at(level, x, y);
  if (node & TreeNodes::kSeed) {
    seeds.corner.push_back(int32_t(x << level)), seeds.corner.push_back(int32_t(y << level));
    seeds.log_size.push_back(int8_t(level));
  }
  if (node & TreeNodes::kSplit)
    for (int child = 0; child < 4; ++child)
      add_seeds(nodes, level - 1, 2 * x + (child & 1), 2 * y + (child >> 1), seeds);
}

Seeds seeds_of(const TreeNodes &nodes) {
  int top = kRootLevel;
  while (nodes.columns(top) > 1 || nodes.rows(top) > 1) ++top;
  Seeds seeds;
  add_seeds(nodes, top, 0, 0, seeds);
  return seeds;
}

}  // namespace

int64_t TreeNodes::memory(int64_t width, int64_t height) {
  const TreeNodes nodes(width, height);
  int64_t bytes = 0;
  for (int level = kMinLevel; level <= kRootLevel + 1; ++level) bytes += nodes.stride(level) * (nodes.rows(level) + 2);
  return bytes;
}

template <class Coder>
void code_tree(Coder &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds) {
  std::optional<TreeNodes> given;
  if (!Coder::kReads) given = tree_of(width, height, seeds);
  TreeNodes nodes(width, height);
  TreeCoding coding(coder.range(), nodes, given ? &*given : nullptr);
  int64_t split = 1, count = 0;
  const auto require_few = [&](int64_t found) {
    if (found > most) throw Error(Fault::limit, "positions: more than " + std::to_string(most) + " seeds");
  };
  for (int level = kRootLevel; level >= kMinLevel && split; --level) {
    split = 0;
    coding.level(level, [&](uint8_t node) {
      if (node & TreeNodes::kSplit) require_few(++split);  // each has seeds
      if (node & TreeNodes::kSeed) require_few(++count);
    });
    coder.record(coding.flags.data(), int64_t(coding.flags.size()));
    coding.flags.clear();
  }
  seeds = seeds_of(nodes);
}

template void code_tree(SymbolReader &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds);
template void code_tree(SymbolWriter &coder, int64_t width, int64_t height, int64_t most, Seeds &seeds);

}  // namespace sgi
