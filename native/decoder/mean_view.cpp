#include "decoder/mean_view.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"

namespace sgi {

namespace {

constexpr int64_t kSourceRows = 64;  // about as many are held at once

}  // namespace

double MeanView::Cover::weight(int64_t at) const { return std::min(high, double(at + 1)) - std::max(low, double(at)); }

MeanView::Cover MeanView::cover(double start, double scale, int64_t index, int64_t size) const {
  const double wider = is_alpha_ ? std::max(0.0, 0.5 - 0.5 / scale) : 0.0;
  const double low = std::clamp(start + double(index) / scale - wider, 0.0, double(size));
  const double high = std::clamp(start + double(index + 1) / scale + wider, 0.0, double(size));
  const int64_t first = std::min(int64_t(low), size - 1);
  return {first, std::max(first, int64_t(std::ceil(high)) - 1), low, high};
}

MeanView::MeanView(const Header &header, const PictureView &view, const Fill &fill, int threads,
                   const std::vector<int> &channels, bool is_alpha)
    : header_(header), view_(view), fill_(fill), threads_(threads), channels_(channels), is_alpha_(is_alpha) {
  for (int64_t i = 0; i < view.columns; ++i) columns_.push_back(cover(view.x, view.sx, i, header.width));
}

void MeanView::draw(int64_t left, int64_t top, const PixelBlock &block, const SampleFormat &format, bool dither) const {
  const int64_t at_once = std::clamp<int64_t>(int64_t(double(kSourceRows) * view_.sy), 1, kSourceRows);
  const int64_t stride = block.columns * header_.spec.channels;
  Source source{columns_[size_t(left)].first, 0, 0, {}};
  source.width = columns_[size_t(left + block.columns - 1)].last + 1 - source.left;
  std::vector<float> values;
  for (int64_t begin = 0; begin < block.rows; begin += at_once) {
    const int64_t rows = std::min(at_once, block.rows - begin), row = top + begin;
    source.top = cover(view_.y, view_.sy, row, header_.height).first;
    const int64_t height = cover(view_.y, view_.sy, row + rows - 1, header_.height).last + 1 - source.top;
    source.samples.resize(size_t(source.width * height * header_.spec.channels)), values.resize(size_t(rows * stride));
    fill_(source.left, source.top, source.width, height, source.samples.data());
    parallel_for(rows, threads_,
                 [&](int64_t i) { average(row + i, left, block.columns, source, &values[size_t(i * stride)]); });
    const PixelBlock part = format.part(block, 0, begin, block.columns, rows);
    if (dither)
      format.store_dithered(values.data(), left, row, part, threads_);
    else
      format.store(values.data(), part, threads_);
  }
}

void MeanView::average(int64_t row, int64_t left, int64_t columns, const Source &source, float *values) const {
  const int count = header_.spec.channels, alpha = header_.alpha();
  const Cover down = cover(view_.y, view_.sy, row, header_.height);
  // The sum of what weigh(line, x) gives for the pixels covered, `line` being the row's first.
  const auto sum = [&](const Cover &across, auto weigh) {
    double sum = 0;
    for (int64_t y = down.first; y <= down.last; ++y) {
      const float *line = source.samples.data() + ((y - source.top) * source.width - source.left) * count;
      double part = 0;
      for (int64_t x = across.first; x <= across.last; ++x) part += weigh(line + x * count, across.weight(x));
      sum += down.weight(y) * part;
    }
    return sum;
  };
  for (int64_t column = left; column < left + columns; ++column, values += count) {
    const Cover &across = columns_[size_t(column)];
    const double area = (down.high - down.low) * (across.high - across.low);
    const double seen = alpha < 0 || is_alpha_
                            ? 0
                            : sum(across, [&](const float *pixel, double part) { return part * double(pixel[alpha]); });
    for (const int c : channels_) {
      const bool is_seen = seen > 0 && c != alpha;
      const double all = sum(across, [&](const float *pixel, double part) {
        return (is_seen ? part * double(pixel[alpha]) : part) * double(pixel[c]);
      });
      const double low = header_.low[size_t(c)], high = header_.high[size_t(c)];
      values[c] = float((all / (is_seen ? seen : area) - low) / (high - low));
    }
  }
}

}  // namespace sgi
