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
constexpr int64_t kStripRows = 64, kMaxStrips = 8;
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

}  // namespace

Restoration::Restoration(std::shared_ptr<const RestorationNetwork> network, int step, int channels, int64_t width,
                         int64_t height, Isa isa)
    : network_(std::move(network)), channels_(channels), seen_(channels >= 3 ? 3 : 1),
      into_(float(kInputUnits / power_of_two(step - kStepOfOne))),
      out_(float(std::ldexp(power_of_two(step - kStepOfOne), -network_->shift))), width_(width), height_(height),
      isa_(isa) {}

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

void Restoration::add(const TilePlanes<const float> &drawn, const OutputAxis &x, const OutputAxis &y, int threads,
                      float *planes) const {
  const TileBlock seen = shown(x, y);
  std::vector<float> memory(size_t(seen.columns) * seen.rows * seen_);
  const TilePlanes<float> correction{memory.data(), seen};
  correct(drawn, threads, correction);
  const std::vector<Cubic> across = cubics(x, seen.left, seen.columns), down = cubics(y, seen.top, seen.rows);
  parallel_for(y.count, threads, [&](int64_t row) {
    std::vector<float> line(seen.columns);
    for (int c = 0; c < seen_; ++c) {
      std::fill(line.begin(), line.end(), 0.0f);
      for (int tap = 0; tap < kCubicTaps; ++tap) {
        const float *source = correction.at(c, seen.left, seen.top + down[row].at[tap]), weight = down[row].weight[tap];
        for (size_t i = 0; i < line.size(); ++i) line[i] += source[i] * weight;
      }
      float *to = planes + (c * y.count + row) * x.count;
      for (int64_t i = 0; i < x.count; ++i)
        for (int tap = 0; tap < kCubicTaps; ++tap) to[i] += line[across[i].at[tap]] * across[i].weight[tap];
    }
  });
}

int64_t Restoration::block_columns(int64_t columns) const {
  const int64_t strips = (columns + strip_columns() - 1) / strip_columns();
  const int64_t blocks = (strips + kMaxStrips - 1) / kMaxStrips;
  return std::min(columns, (strips + blocks - 1) / blocks * strip_columns());
}

int64_t Restoration::strip_columns() const { return kRestorationColumns - 2 * (network_->reach() - 1); }

void Restoration::correct(const TilePlanes<const float> &drawn, int threads,
                          const TilePlanes<float> &correction) const {
  const RestorationKernel &kernel = kernel_for<RestorationKernel>(isa_);
  const std::vector<float> nothing(size_t(strip_columns()), 0.0f);
  run_strips(drawn, correction.block, threads, [&](const TileBlock &strip, const int32_t *sums) {
    for (int64_t row = 0; row < strip.rows; ++row)
      for (int c = 0; c < seen_; ++c)
        kernel.add(sums + (c * strip.rows + row) * kRestorationStride, strip.columns, out_, nothing.data(),
                   correction.at(c, strip.left, strip.top + row));
  });
}

void Restoration::restore(const TilePlanes<const float> &drawn, const TileBlock &block, int threads,
                          const RowSink &sink) const {
  const RestorationKernel &kernel = kernel_for<RestorationKernel>(isa_);
  run_strips(drawn, block, threads, [&](const TileBlock &strip, const int32_t *sums) {
    std::vector<float> restored(size_t(strip.columns * seen_));
    std::vector<const float *> channels(channels_);
    for (int64_t row = 0; row < strip.rows; ++row) {
      for (int c = 0; c < channels_; ++c) {
        channels[c] = drawn.at(c, strip.left, strip.top + row);
        if (c >= seen_) continue;
        float *const to = &restored[size_t(c * strip.columns)];
        kernel.add(sums + (c * strip.rows + row) * kRestorationStride, strip.columns, out_, channels[c], to);
        channels[c] = to;
      }
      sink(strip.left, strip.top + row, strip.columns, channels.data());
    }
  });
}

// Hands out the sums of the last layer for strips of a block, `kRestorationStride` from one row to the next.
void Restoration::run_strips(const TilePlanes<const float> &drawn, const TileBlock &block, int threads,
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
const int32_t *Restoration::run(const TilePlanes<const float> &drawn, const TileBlock &strip) const {
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
void Restoration::read_inputs(const TilePlanes<const float> &drawn, const TileBlock &strip, int64_t rows,
                              int32_t *inputs) const {
  const RestorationKernel &kernel = kernel_for<RestorationKernel>(isa_);
  const int64_t reach = network_->reach(), first = strip.left - reach;
  // of those columns that are drawn; beyond the strip's own margin nothing that is sound depends on others
  const int64_t begin = std::max<int64_t>(0, -first);
  const int64_t end = std::min<int64_t>(kRestorationColumns + 2, drawn.block.left + drawn.block.columns - first);
  for (int64_t row = 0; row < rows; ++row) {
    const int64_t y = std::clamp<int64_t>(strip.top - reach + row, 0, height_ - 1);
    int32_t *to[] = {inputs + row * kRestorationStride, inputs + (rows + row) * kRestorationStride};
    kernel.inputs(drawn.at(0, first + begin, y), drawn.size(), seen_, end - begin, into_, to[0] + begin, to[1] + begin);
    for (int32_t *line : to) {
      std::fill(line, line + begin, line[begin]);
      std::fill(line + end, line + kRestorationColumns + 2, line[end - 1]);
    }
  }
}

}  // namespace sgi
