#include "bitstream/given_tree.hpp"

#include <algorithm>
#include <string>

#include "base/error.hpp"
#include "model/morton.hpp"

namespace sgi {

GivenTree::GivenTree(const TreeScenery &scenery, const int32_t *corner, const int8_t *log_size, int64_t count)
    : count_(count) {
  const auto fault = [](const char *text) { return Error(Fault::usage, std::string("positions: ") + text); };
  for (int64_t i = 0; i < count; ++i) {
    const int32_t x = corner[2 * i], y = corner[2 * i + 1];
    const int level = log_size[i];
    if (level < kMinLevel || level > kRootLevel || x < 0 || y < 0 || x >= scenery.width() || y >= scenery.height() ||
        (x | y) & ((1 << level) - 1))
      throw fault("a seed is no node of the tree: outside, off its grid, of another size");
    const int64_t code = morton(x, y);
    seeds_[size_t(level)].push_back(code >> 2 * level);
    for (int above = level + 1; above <= kRootLevel; ++above) splits_[size_t(above)].push_back(code >> 2 * above);
  }
  for (Levels *levels : {&seeds_, &splits_})
    for (std::vector<int64_t> &codes : *levels) std::sort(codes.begin(), codes.end());
  for (const std::vector<int64_t> &codes : seeds_)
    if (std::adjacent_find(codes.begin(), codes.end()) != codes.end()) throw fault("two seeds share one node");
}

void GivenTree::fill(const TreeBatch &batch, bool is_split, uint8_t *flags) const {
  const std::vector<int64_t> &codes = (is_split ? splits_ : seeds_)[size_t(batch.of.level())];
  for (const int32_t parent : batch.members)
    *flags++ = std::binary_search(codes.begin(), codes.end(), batch.of.code(parent, batch.child));
}

}  // namespace sgi
