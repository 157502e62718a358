#include "decoder/exact_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "decoder/mean_view.hpp"

namespace sgi {

namespace {

constexpr int64_t kRowsAtOnce = 64;

// Output pixels along an axis whose centres lie in pixels first ... last - 1 of the picture, among those before
// `count`.
struct Span {
  int64_t begin, end;
};

int64_t pixel_of(double start, double scale, int64_t index) {
  return int64_t(std::floor(start + (double(index) + 0.5) / scale));
}

Span span_of(double start, double scale, int64_t first, int64_t last, int64_t from, int64_t count) {
  const auto bound = [&](int64_t pixel) {
    auto at = std::clamp(int64_t((double(pixel) - start) * scale) - 1, from, count);
    while (at < count && pixel_of(start, scale, at) < pixel) ++at;
    return at;
  };
  return {bound(first), bound(last)};
}

// Copies the cells of a block of the layer from a view of samples into rows that were drawn without them.
class CellView {
 public:
  CellView(const ExactView &exact, const MeanView &samples, ExactBlocks &blocks)
      : exact_(exact), samples_(samples), blocks_(blocks) {}

  // Those of the block that holds pixel (x, y).
  void copy(int64_t x, int64_t y, int64_t top, const PixelBlock &out) {
    const ExactBlocks::Place place = blocks_.around(x, y);
    const PictureView &view = exact_.view;
    const Span across = span_of(view.x, view.sx, place.x, place.x + place.width, 0, view.columns);
    const Span down = span_of(view.y, view.sy, place.y, place.y + place.height, top, top + out.rows);
    if (across.begin == across.end || down.begin == down.end) return;
    const std::vector<uint8_t> cells = blocks_.cells(x, y, exact_.draw);
    columns_.clear();
    for (int64_t column = across.begin; column < across.end; ++column)
      columns_.push_back((pixel_of(view.x, view.sx, column) - place.x) / kResidualCell);
    const int64_t cells_across = (place.width + kResidualCell - 1) / kResidualCell;
    for (int64_t row = down.begin; row < down.end; row += kRowsAtOnce) {
      const Span rows{row, std::min(down.end, row + kRowsAtOnce)};
      const auto of_row = [&](int64_t at) {
        return &cells[size_t((pixel_of(view.y, view.sy, at) - place.y) / kResidualCell * cells_across)];
      };
      const uint8_t *first = of_row(rows.begin), *last = of_row(rows.end - 1) + cells_across;
      if (std::any_of(first, last, [](uint8_t cell) { return cell; }))
        copy_rows(across, rows, exact_.format.part(out, 0, rows.begin - top, out.columns, rows.end - rows.begin),
                  of_row);
    }
  }

 private:
  template <class OfRow>
  void copy_rows(const Span &across, const Span &down, const PixelBlock &out, const OfRow &of_row) {
    const int64_t columns = across.end - across.begin, stride = columns * exact_.format.channels;
    const int64_t bytes = exact_.format.channels * exact_.format.sample_bytes();
    shown_.resize(size_t((down.end - down.begin) * columns * bytes));
    const PixelBlock shown{shown_.data(), columns, down.end - down.begin, stride};
    samples_.draw(across.begin, down.begin, shown, exact_.format, exact_.dither);
    for (int64_t row = down.begin; row < down.end; ++row) {
      const uint8_t *cells = of_row(row), *from = &shown_[size_t((row - down.begin) * columns * bytes)];
      auto *to = static_cast<uint8_t *>(out.first) + (row - down.begin) * out.stride * exact_.format.sample_bytes() +
                 across.begin * bytes;
      for (int64_t i = 0; i < columns; ++i)
        if (cells[columns_[size_t(i)]]) std::memcpy(to + i * bytes, from + i * bytes, size_t(bytes));
    }
  }

  const ExactView &exact_;
  const MeanView &samples_;
  ExactBlocks &blocks_;
  std::vector<int64_t> columns_;  // the cell of each output column
  std::vector<uint8_t> shown_;
};

// Copies channels of a view of samples into rows that were drawn without them.
void copy_channels(const std::vector<int> &channels, const ExactView &exact, const MeanView &samples, int64_t top,
                   const PixelBlock &out) {
  const auto bytes = size_t(exact.format.sample_bytes()), pixel = size_t(exact.format.channels) * bytes;
  std::vector<uint8_t> shown(size_t(std::min(kRowsAtOnce, out.rows) * out.columns) * pixel);
  for (int64_t row = 0; row < out.rows; row += kRowsAtOnce) {
    const int64_t rows = std::min(kRowsAtOnce, out.rows - row);
    const PixelBlock part{shown.data(), out.columns, rows, out.columns * exact.format.channels};
    samples.draw(0, top + row, part, exact.format, exact.dither);
    for (int64_t y = 0; y < rows; ++y) {
      auto *to = static_cast<uint8_t *>(out.first) + size_t((row + y) * out.stride) * bytes;
      const uint8_t *from = &shown[size_t(y * out.columns) * pixel];
      for (size_t i = 0; i < size_t(out.columns); ++i)
        for (const int c : channels)
          std::memcpy(to + i * pixel + size_t(c) * bytes, from + i * pixel + size_t(c) * bytes, bytes);
    }
  }
}

}  // namespace

void ExactView::fill(ExactBlocks &blocks, int64_t top, const PixelBlock &block) const {
  const MeanView::Fill samples = [&](int64_t x, int64_t y, int64_t columns, int64_t rows, float *out) {
    blocks.fill(x, y, {out, columns, rows, columns * header.spec.channels}, SampleType::f32, draw);
  };
  const MeanView mean(header, view, samples, threads, blocks.channels(), blocks.is_alpha());
  if (!blocks.has_all_channels()) return copy_channels(blocks.channels(), *this, mean, top, block);
  if (!blocks.has_cells()) return mean.draw(0, top, block, format, dither);
  const auto end = [](int64_t last, int64_t side) {
    return std::min(last, side - 1) / kResidualBlock * kResidualBlock;
  };
  const auto begin = [](int64_t first) { return std::max<int64_t>(first, 0) / kResidualBlock * kResidualBlock; };
  const int64_t last_x = end(pixel_of(view.x, view.sx, view.columns - 1), header.width);
  const int64_t last_y = end(pixel_of(view.y, view.sy, top + block.rows - 1), header.height);
  CellView cells(*this, mean, blocks);
  for (int64_t y = begin(pixel_of(view.y, view.sy, top)); y <= last_y; y += kResidualBlock)
    for (int64_t x = begin(pixel_of(view.x, view.sx, 0)); x <= last_x; x += kResidualBlock)
      if (blocks.is_coded(x, y)) cells.copy(x, y, top, block);
}

}  // namespace sgi
