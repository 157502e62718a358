#include "model/texture_drawing.hpp"

#include <algorithm>

namespace sgi {

TextureDrawing::TextureDrawing(const Texture &texture, const OutputAxis &x, const OutputAxis &y,
                               const TextureBlocks &blocks, Isa isa)
    : texture_(texture), blocks_(blocks), columns_(x.count), rows_(y.count), kernel_(kernel_for<TextureKernel>(isa)),
      along_(x, texture.width, {texture.grid.separate, texture.grid.left}, true,
             {texture.corner, texture.log_size, texture.count}),
      downward_(y, texture.height, {texture.grid.separate, texture.grid.top}, false,
                {texture.corner + 1, texture.log_size, texture.count}),
      bins_(texture, along_, downward_, blocks, x.count, y.count) {}

bool TextureDrawing::draw(int64_t column, int64_t row, float *planes) const {
  const int64_t block = row * bins_.across + column;
  if (bins_.first(block) == bins_.last(block)) return false;
  const int64_t left = column * blocks_.width - blocks_.before, top = row * blocks_.height - blocks_.above;
  const int64_t x0 = std::max<int64_t>(0, left), x1 = std::min(left + blocks_.width, columns_);
  const int64_t y0 = std::max<int64_t>(0, top), y1 = std::min(top + blocks_.height, rows_);
  std::fill_n(planes, texture_.channels * blocks_.height * blocks_.stride, 0.0f);
  for (const int64_t *cell = bins_.first(block); cell != bins_.last(block); ++cell)
    add_cell(*cell, x0, x1, y0, y1, left, top, planes);
  return true;
}

// Adds what a cell has in the pixels x0 ... x1 - 1 and y0 ... y1 - 1 to planes, whose first pixel is (left, top).
void TextureDrawing::add_cell(int64_t cell, int64_t x0, int64_t x1, int64_t y0, int64_t y1, int64_t left, int64_t top,
                              float *planes) const {
  const int log_size = texture_.log_size[cell], side = 1 << log_size;
  const CellAxis &h = *along_.cells(texture_.corner[2 * cell], log_size);
  const CellAxis &v = *downward_.cells(texture_.corner[2 * cell + 1], log_size);
  const int64_t first = std::max(x0, h.first), last = std::min(x1, h.first + h.count);
  const int64_t upper = std::max(y0, v.first), lower = std::min(y1, v.first + v.count);
  TexturePart part;
  part.side = side;
  part.across = along_.values() + h.at + (first - h.first);
  part.across_stride = h.stride;
  part.down = downward_.values() + v.at + (upper - v.first) * v.stride;
  part.rows = int(lower - upper);
  part.columns = int(last - first);
  for (int c = 0; c < texture_.channels; ++c) {
    const int64_t channel = cell * texture_.channels + c;
    const Waves &waves = texture_.waves[channel];
    if (!waves.across) continue;
    part.amplitudes = texture_.amplitudes[channel];
    part.waves_down = waves.down;
    part.waves_across = waves.across;
    kernel_.add(part, planes + (c * blocks_.height + upper - top) * blocks_.stride + first - left, blocks_.stride);
  }
}

}  // namespace sgi
