#include "model/restoration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/exact.hpp"
#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int kStepOfOne = 480, kInputUnits = 128;
constexpr int64_t kStripRows = 64;
constexpr int kCubicBefore = 1, kCubicTaps = 4;

// The first and last pixel and one on of an axis of `size` that its output pixels show.
std::array<int64_t, 2> shown_of(const OutputAxis &axis, int64_t size) {
  if (axis.is_plain())
    return {std::clamp<int64_t>(axis.first, 0, size - 1), std::clamp<int64_t>(axis.first + axis.count, 1, size)};
  const auto cell = [&](int64_t i) { return int64_t(std::floor(axis.centre(i) - 0.5)) - kCubicBefore; };
  return {std::clamp<int64_t>(cell(0), 0, size - 1), std::clamp<int64_t>(cell(axis.count - 1) + kCubicTaps, 1, size)};
}

// Catmull-Rom weights of the four pixels around each output pixel, and their places in `shown`, from `begin` on.
struct Cubic {
  std::array<int32_t, kCubicTaps> at;
  std::array<float, kCubicTaps> weight;
};

std::vector<Cubic> cubics(const OutputAxis &axis, int64_t begin, int64_t size) {
  std::vector<Cubic> found(axis.count);
  for (int64_t i = 0; i < axis.count; ++i) {
    const double place = axis.centre(i) - 0.5, low = std::floor(place);
    for (int tap = 0; tap < kCubicTaps; ++tap) {
      const double d = std::abs(place - (low + tap - kCubicBefore));
      const double near = (1.5 * d - 2.5) * d * d + 1.0, far = ((-0.5 * d + 2.5) * d - 4.0) * d + 2.0;
      found[i].weight[tap] = float(d <= 1 ? near : far);
      found[i].at[tap] = int32_t(std::clamp<int64_t>(int64_t(low) + tap - kCubicBefore - begin, 0, size - 1));
    }
  }
  return found;
}

// The transpose of [n, n], and its inverse, for n of 1 or 3.
std::vector<double> transposed(const std::vector<double> &m) {
  if (m.size() == 1) return m;
  return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]};
}

std::vector<double> inverse(const std::vector<double> &m) {
  if (m.size() == 1) return {1 / m[0]};
  const auto minor = [&](int a, int b, int c, int d) { return m[a] * m[d] - m[b] * m[c]; };
  const double determinant = m[0] * minor(4, 5, 7, 8) - m[1] * minor(3, 5, 6, 8) + m[2] * minor(3, 4, 6, 7);
  std::vector<double> found{minor(4, 5, 7, 8), minor(2, 1, 8, 7), minor(1, 2, 4, 5),
                            minor(5, 3, 8, 6), minor(0, 2, 6, 8), minor(2, 0, 5, 3),
                            minor(3, 4, 6, 7), minor(1, 0, 7, 6), minor(0, 1, 3, 4)};
  for (double &value : found) value /= determinant;
  return found;
}

std::vector<float> scaled(const std::vector<double> &m, double factor) {
  std::vector<float> found;
  for (const double value : m) found.push_back(float(value * factor));
  return found;
}

}  // namespace

Restoration::Restoration(std::shared_ptr<const RestorationNetwork> network, int step, int channels,
                         const std::vector<float> &mix, int64_t width, int64_t height, Isa isa)
    : network_(std::move(network)), channels_(channels), mixed_(channels >= 3 ? 3 : 1), width_(width), height_(height),
      isa_(isa) {
  const double size = power_of_two(step - kStepOfOne);
  std::vector<double> out{1};
  if (mixed_ == 3) out = transposed({mix.begin(), mix.end()});
  into_ = scaled(inverse(out), kInputUnits / size);
  out_ = scaled(out, std::ldexp(size, -network_->shift));
}

TileBlock Restoration::shown(const OutputAxis &x, const OutputAxis &y) const {
  const auto across = shown_of(x, width_), down = shown_of(y, height_);
  return {across[0], down[0], across[1] - across[0], down[1] - down[0]};
}

TileBlock Restoration::needed(const OutputAxis &x, const OutputAxis &y) const {
  const TileBlock seen = shown(x, y);
  const int64_t reach = network_->reach();
  const int64_t left = std::max<int64_t>(0, seen.left - reach), top = std::max<int64_t>(0, seen.top - reach);
  return {left, top, std::min(width_, seen.left + seen.columns + reach) - left,
          std::min(height_, seen.top + seen.rows + reach) - top};
}

void Restoration::add(const float *drawn, const OutputAxis &x, const OutputAxis &y, int threads, float *values) const {
  const TileBlock seen = shown(x, y);
  const TilePixels<const float> from = interleaved(drawn, needed(x, y), channels_);
  std::vector<float> correction(size_t(seen.columns) * seen.rows * channels_, 0.0f);
  correct(from, threads, interleaved(correction.data(), seen, channels_));
  const std::vector<Cubic> across = cubics(x, seen.left, seen.columns), down = cubics(y, seen.top, seen.rows);
  parallel_for(y.count, threads, [&](int64_t row) {
    std::vector<float> line(size_t(seen.columns) * channels_, 0.0f);
    for (int tap = 0; tap < kCubicTaps; ++tap) {
      const float *source = &correction[size_t(down[row].at[tap]) * line.size()], weight = down[row].weight[tap];
      for (size_t i = 0; i < line.size(); ++i) line[i] += source[i] * weight;
    }
    float *to = values + row * x.count * channels_;
    for (int64_t i = 0; i < x.count; ++i)
      for (int c = 0; c < mixed_; ++c)
        for (int tap = 0; tap < kCubicTaps; ++tap)
          to[i * channels_ + c] += line[size_t(across[i].at[tap]) * channels_ + c] * across[i].weight[tap];
  });
}

int64_t Restoration::strip_columns() const { return kRestorationColumns - 2 * (network_->reach() - 1); }

void Restoration::correct(const TilePixels<const float> &drawn, int threads, const TilePixels<float> &values) const {
  const RestorationMix mix{out_.data(), mixed_, values.pixel, values.channel};
  run_strips(drawn, values.block, threads, [&](const TileBlock &strip, const int32_t *sums) {
    for (int64_t row = 0; row < strip.rows; ++row)
      add_row(strip, row, sums, mix, values.at(strip.left, strip.top + row));
  });
}

void Restoration::restore(const TilePixels<const float> &drawn, const TileBlock &block, int threads,
                          const RowSink &sink) const {
  const RestorationMix mix{out_.data(), mixed_, channels_, 1};
  run_strips(drawn, block, threads, [&](const TileBlock &strip, const int32_t *sums) {
    std::vector<float> values(size_t(strip.columns * channels_));
    for (int64_t row = 0; row < strip.rows; ++row) {
      std::copy_n(drawn.at(strip.left, strip.top + row), values.size(), values.data());
      add_row(strip, row, sums, mix, values.data());
      sink(strip.left, strip.top + row, strip.columns, values.data());
    }
  });
}

// Adds what the sums of a strip make of one of its rows.
void Restoration::add_row(const TileBlock &strip, int64_t row, const int32_t *sums, const RestorationMix &mix,
                          float *values) const {
  kernel_for<RestorationKernel>(isa_).add(sums + row * kRestorationStride, strip.rows * kRestorationStride,
                                          strip.columns, mix, values);
}

// Hands out the sums of the last layer for strips of a block, `kRestorationStride` from one row to the next.
void Restoration::run_strips(const TilePixels<const float> &drawn, const TileBlock &block, int threads,
                             const StripSink &sink) const {
  const int64_t columns = strip_columns();
  const int64_t across = (block.columns + columns - 1) / columns, down = (block.rows + kStripRows - 1) / kStripRows;
  parallel_for(across * down, threads, [&](int64_t i) {
    const int64_t left = i % across * columns, top = i / across * kStripRows;
    const TileBlock strip{block.left + left, block.top + top, std::min(columns, block.columns - left),
                          std::min(kStripRows, block.rows - top)};
    sink(strip, run(drawn, strip));
  });
}

// The sums of the last layer for a strip. They last until the thread runs another one.
const int32_t *Restoration::run(const TilePixels<const float> &drawn, const TileBlock &strip) const {
  thread_local std::vector<int32_t> memory;
  const RestorationKernel &kernel = kernel_for<RestorationKernel>(isa_);
  int64_t rows = strip.rows + 2 * network_->reach(), most = kRestorationLast;
  for (const RestorationLayer &layer : network_->layers) most = std::max<int64_t>(most, 2 * layer.view().blocks);
  // Behind the columns of a layer there are what inputs or zeros were there before: nothing sound depends on them.
  const size_t size = most * rows * kRestorationStride;
  if (memory.size() < 2 * size) memory.resize(2 * size);
  int32_t *one = memory.data(), *other = one + size;
  read_inputs(drawn, strip, rows, one);
  bool small = false;
  int64_t columns = strip.columns + 2 * network_->reach();
  for (const RestorationLayer &layer : network_->layers) {
    rows -= 2, columns -= 2;
    if (&layer == &network_->layers.back())
      kernel.last(layer.view(), one, rows, columns, other);
    else
      small = kernel.hidden(layer.view(), one, rows, columns, small, other);
    std::swap(one, other);
  }
  return one;
}

// Those of a strip and what is around it: beyond the tile, its nearest pixels.
void Restoration::read_inputs(const TilePixels<const float> &drawn, const TileBlock &strip, int64_t rows,
                              int32_t *inputs) const {
  const RestorationMix mix{into_.data(), mixed_, drawn.pixel, drawn.channel};
  const RestorationKernel &kernel = kernel_for<RestorationKernel>(isa_);
  const int64_t reach = network_->reach(), first = strip.left - reach;
  // of those columns that are drawn; beyond the strip's own margin nothing that is sound depends on others
  const int64_t begin = std::max<int64_t>(0, -first);
  const int64_t end = std::min<int64_t>(kRestorationColumns + 2, drawn.block.left + drawn.block.columns - first);
  for (int64_t row = 0; row < rows; ++row) {
    const int64_t y = std::clamp<int64_t>(strip.top - reach + row, 0, height_ - 1);
    int32_t *to[] = {inputs + row * kRestorationStride, inputs + (rows + row) * kRestorationStride};
    kernel.inputs(drawn.at(first + begin, y), end - begin, mix, to[0] + begin, to[1] + begin);
    for (int32_t *line : to) {
      std::fill(line, line + begin, line[begin]);
      std::fill(line + end, line + kRestorationColumns + 2, line[end - 1]);
    }
  }
}

}  // namespace sgi
