// Masks: which pixels of a tile hold nothing (docs/format.md, "Masks").
#pragma once
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"

namespace sgi {

// A quadtree of a tile's pixels, as it was read: memory follows the payload, not the picture.
class MaskTree {
 public:
  // The whole tile is empty.
  MaskTree(int64_t width, int64_t height) : width_(width), height_(height) {}
  // Throws Error: corrupt, limit.
  static MaskTree read(Bytes payload, int64_t width, int64_t height);

  // Whether some pixels hold something and others nothing.
  bool is_mixed() const;
  // Whether the pixels at columns x and rows y of the tile, ascending both, hold nothing, into out [rows, columns].
  void sample(const int64_t *x, int64_t columns, const int64_t *y, int64_t rows, uint8_t *out) const;
  int64_t memory() const;

  // What a link says instead of a node's number: all pixels hold something, none does, or there are none.
  static constexpr int32_t kClear = -1, kSet = -2, kBeyond = -3;

 private:
  int64_t width_, height_;
  // From the root's children down to pixels, the links [n, 4] of the mixed nodes above: a child's number among the
  // mixed nodes of its level, or one of those. Without levels all pixels hold nothing.
  std::vector<std::vector<int32_t>> levels_;
};

}  // namespace sgi
