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
  MaskTree(int64_t width, int64_t height);
  // Throws Error: corrupt, limit.
  static MaskTree read(Bytes payload, int64_t width, int64_t height);

  bool is_mixed() const;
  // Whether the pixels at columns x and rows y of the tile hold nothing, into out [rows, columns].
  void sample(const int64_t *x, int64_t columns, const int64_t *y, int64_t rows, uint8_t *out) const;
  int64_t memory() const;
};

}  // namespace sgi
