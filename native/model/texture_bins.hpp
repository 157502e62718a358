// Which cells of texture each block of pixels shows.
#pragma once
#include <cstdint>
#include <vector>

#include "model/texture.hpp"

namespace sgi {

// Blocks of pixels, the first of which begins so many pixels before the first pixel; stride: of a row of a block, at
// least its width and kTexturePadding.
struct TextureBlocks {
  int64_t before, above, width, height, stride;
};

// In their order.
class TextureBins {
 public:
  // columns, rows: of all pixels.
  TextureBins(const Texture &texture, const TextureAxis &x, const TextureAxis &y, const TextureBlocks &blocks,
              int64_t columns, int64_t rows)
      : across((blocks.before + columns + blocks.width - 1) / blocks.width),
        down((blocks.above + rows + blocks.height - 1) / blocks.height), blocks_(blocks), start_(across * down + 1) {
    for_each_pair(texture, x, y, [&](int64_t block, int64_t) { ++start_[block + 1]; });
    for (size_t block = 1; block < start_.size(); ++block) start_[block] += start_[block - 1];
    cells_.resize(start_.back());
    std::vector<int64_t> to(start_.begin(), start_.end() - 1);
    for_each_pair(texture, x, y, [&](int64_t block, int64_t cell) { cells_[to[block]++] = cell; });
  }

  const int64_t across, down;
  const int64_t *first(int64_t block) const { return cells_.data() + start_[block]; }
  const int64_t *last(int64_t block) const { return cells_.data() + start_[block + 1]; }

 private:
  template <class Body>
  void for_each_pair(const Texture &texture, const TextureAxis &x, const TextureAxis &y, Body body) {
    for (int64_t i = 0; i < texture.count; ++i) {
      const CellAxis *h = x.cells(texture.corner[2 * i], texture.log_size[i]);
      const CellAxis *v = y.cells(texture.corner[2 * i + 1], texture.log_size[i]);
      if (!h || !v) continue;
      const int64_t left = blocks_.before + h->first, top = blocks_.above + v->first;
      for (int64_t r = top / blocks_.height; r <= (top + v->count - 1) / blocks_.height; ++r)
        for (int64_t c = left / blocks_.width; c <= (left + h->count - 1) / blocks_.width; ++c) body(r * across + c, i);
    }
  }

  const TextureBlocks blocks_;
  std::vector<int64_t> start_, cells_;
};

}  // namespace sgi
