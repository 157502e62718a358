#include "model/texture_drawing.hpp"

#include <algorithm>

#include "model/texture_bins.hpp"
#include "model/texture_kernel.hpp"

namespace sgi {
struct TextureDrawing::Prepared {
  Prepared(const Texture &shown, const OutputAxis &x, const OutputAxis &y, const TextureBlocks &blocks_, Isa isa)
      : texture(shown), blocks(blocks_), columns(x.count), rows(y.count), kernel(kernel_for<TextureKernel>(isa)),
        along(x, texture.width, true, {texture.corner, texture.log_size, texture.count}),
        downward(y, texture.height, false, {texture.corner + 1, texture.log_size, texture.count}),
        bins(texture, along, downward, blocks, columns, rows) {}

  // Adds what a cell has in the pixels x0 ... x1 - 1 and y0 ... y1 - 1 to planes, whose first pixel is (left, top).
  void add_cell(int64_t cell, int64_t x0, int64_t x1, int64_t y0, int64_t y1, int64_t left, int64_t top,
                float *planes) const {
    const int log_size = texture.log_size[cell], side = 1 << log_size;
    const CellAxis &h = *along.cells(texture.corner[2 * cell], log_size);
    const CellAxis &v = *downward.cells(texture.corner[2 * cell + 1], log_size);
    const int64_t first = std::max(x0, h.first), last = std::min(x1, h.first + h.count);
    const int64_t upper = std::max(y0, v.first), lower = std::min(y1, v.first + v.count);
    TexturePart part;
    part.side = side;
    part.across = along.values() + h.at + (first - h.first);
    part.across_stride = h.stride;
    part.down = downward.values() + v.at + (upper - v.first) * v.stride;
    part.rows = int(lower - upper);
    part.columns = int(last - first);
    for (int c = 0; c < texture.channels; ++c) {
      const Waves &waves = texture.waves[cell * texture.channels + c];
      if (!waves.across) continue;
      part.amplitudes = texture.amplitudes[cell] + c * side * side;
      part.waves_down = waves.down;
      part.waves_across = waves.across;
      kernel.add(part, planes + (c * blocks.height + upper - top) * blocks.stride + first - left, blocks.stride);
    }
  }

  const Texture texture;
  const TextureBlocks blocks;
  const int64_t columns, rows;
  const TextureKernel &kernel;
  const TextureAxis along, downward;
  const TextureBins bins;
};

TextureDrawing::TextureDrawing(const Texture &texture, const OutputAxis &x, const OutputAxis &y,
                               const TextureBlocks &blocks, Isa isa)
    : prepared_(std::make_unique<const Prepared>(texture, x, y, blocks, isa)) {}

TextureDrawing::~TextureDrawing() = default;
int64_t TextureDrawing::across() const { return prepared_->bins.across; }
int64_t TextureDrawing::down() const { return prepared_->bins.down; }

bool TextureDrawing::draw(int64_t column, int64_t row, float *planes) const {
  const Prepared &p = *prepared_;
  const int64_t block = row * p.bins.across + column;
  if (p.bins.first(block) == p.bins.last(block)) return false;
  const int64_t left = column * p.blocks.width - p.blocks.before, top = row * p.blocks.height - p.blocks.above;
  const int64_t x0 = std::max<int64_t>(0, left), x1 = std::min(left + p.blocks.width, p.columns);
  const int64_t y0 = std::max<int64_t>(0, top), y1 = std::min(top + p.blocks.height, p.rows);
  std::fill_n(planes, p.texture.channels * p.blocks.height * p.blocks.stride, 0.0f);
  for (const int64_t *cell = p.bins.first(block); cell != p.bins.last(block); ++cell)
    p.add_cell(*cell, x0, x1, y0, y1, left, top, planes);
  return true;
}

}  // namespace sgi
