#include "decoder/samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/thread_pool.hpp"
#include "model/colours.hpp"
#include "raster/sample_values.hpp"

namespace sgi {
namespace {

constexpr int64_t kApart = 56;      // pixels by which the noise of a channel is shifted
constexpr double kRounding = 1e-3;  // levels by which a sample may be off for the rounding of floats

// Nodata in another type; 0 for one that lies outside the range of samples or is not a number, or where ranges differ.
double converted(double nodata, const Header &header, SampleType type) {
  const double low = header.low[0], high = header.high[0];
  for (int c = 1; c < header.colours(); ++c)
    if (header.low[c] != low || header.high[c] != high) return 0;
  if (!(low <= nodata && nodata <= high)) return 0;
  const double value = largest_of(type) * (nodata - low) / (high - low);
  return type == SampleType::f32 ? double(float(value)) : std::nearbyint(value);
}

double nodata_in(const Header &header, SampleType type, std::optional<double> nodata) {
  if (type == header.sample_type) return header.masked == Masked::nodata ? header.nodata : nodata.value_or(0);
  return nodata ? converted(*nodata, header, type) : 0;
}

// Interleaved gradient noise (Jimenez 2014).
double threshold_at(int64_t x, int64_t y, int channel) {
  const auto fraction = [](double value) { return value - std::trunc(value); };
  const double across = double(x + kApart * channel), down = double(y + 2 * kApart * channel);
  return fraction(52.9829189 * fraction(0.06711056 * across + 0.00583715 * down));
}

template <class T>
T beside(double nodata, double low, double high) {
  if constexpr (std::is_floating_point_v<T>)
    return std::nextafter(T(nodata), T((low + high) / 2));
  else
    return T(nodata + (nodata < (low + high) / 2 ? 1 : -1));
}

template <class T>
bool equals(T sample, double value) {
  return std::isnan(value) ? sample != sample : sample == T(value);
}

}  // namespace

SampleFormat::SampleFormat(const Header &header, Output output, std::optional<double> nodata, Isa isa)
    : type(output.value_or(SampleType::f32)), channels(header.spec.channels), alpha(header.alpha()),
      blank(nodata ? nodata_in(header, output.value_or(header.sample_type), nodata) : 0), isa(isa),
      is_mapped_(output.has_value()), is_source_(type == header.sample_type),
      has_nodata_(header.masked == Masked::nodata), from_(is_source_ ? header.low : std::vector<double>(channels, 0)),
      to_(is_source_ ? header.high : std::vector<double>(channels, largest_of(type))), source_from_(header.low),
      source_to_(header.high), nodata_(nodata_in(header, type, nodata)), low_(channels), span_(channels),
      mix_(sample_mix(header.spec)) {
  for (int c = 0; c < channels; ++c) low_[c] = float(from_[c]), span_[c] = float(to_[c] - from_[c]);
}

PixelBlock SampleFormat::part(const PixelBlock &block, int64_t left, int64_t top, int64_t columns, int64_t rows) const {
  uint8_t *first = static_cast<uint8_t *>(block.first) + (top * block.stride + left * channels) * sample_bytes();
  return {first, columns, rows, block.stride};
}

Samples SampleFormat::samples(const PixelBlock &block) const {
  return {block.first, block.stride, type, low_.data(), span_.data(), is_mapped_, mix_.empty() ? nullptr : mix_.data()};
}

void SampleFormat::store_channels(const float *const *rows, const PixelBlock &block) const {
  kernel_for<FinishKernel>(isa).store_channels(rows, block.columns, channels, samples(block));
}

namespace {

// Calls body(row) for all rows of a block, a few at a time on several threads.
template <class Body>
void for_each_row(const PixelBlock &block, int threads, Body body) {
  const int64_t run = std::max<int64_t>(1, (int64_t(1) << 14) / std::max<int64_t>(1, block.columns));
  parallel_for((block.rows + run - 1) / run, threads, [&](int64_t part) {
    for (int64_t row = part * run; row < std::min(block.rows, (part + 1) * run); ++row) body(row);
  });
}

}  // namespace

void SampleFormat::store(const float *values, const PixelBlock &block, int threads) const {
  for_each_row(block, threads, [&](int64_t row) {
    const PixelBlock here = part(block, 0, row, block.columns, 1);
    kernel_for<FinishKernel>(isa).store(values + row * block.columns * channels, block.columns, channels,
                                        samples(here));
  });
}

void SampleFormat::store_dithered(const float *values, int64_t x, int64_t y, const PixelBlock &block,
                                  int threads) const {
  for_each_row(block, threads, [&](int64_t row) {
    const float *from = values + row * block.columns * channels;
    uint8_t *to = static_cast<uint8_t *>(block.first) + row * block.stride;
    for (int64_t i = 0; i < block.columns; ++i)
      for (int c = 0; c < channels; ++c, ++from, ++to) {
        const double noise = c == alpha ? 0.5 : threshold_at(x + i, y + row, c);
        const float sample = *from * span_[c] + low_[c] + float(kRounding + (1 - 2 * kRounding) * noise);
        *to = uint8_t(sample > 0 ? std::floor(std::min(sample, 255.0f)) : 0.0f);
      }
  });
}

void SampleFormat::fill(double sample, const PixelBlock &block) const {
  with_sample(type, [&](auto kind) {
    using T = decltype(kind);
    for (int64_t row = 0; row < block.rows; ++row)
      std::fill_n(static_cast<T *>(block.first) + row * block.stride, block.columns * channels, T(sample));
  });
}

template <class T>
T SampleFormat::beside_nodata(int channel) const {
  return beside<T>(nodata_, from_[channel], to_[channel]);
}

void SampleFormat::mark_transparent(const uint8_t *empty, const PixelBlock &row) const {
  with_sample(type, [&](auto kind) {
    auto *samples = static_cast<decltype(kind) *>(row.first);
    for (int64_t i = 0; i < row.columns; ++i)
      if (empty[i]) samples[i * channels + alpha] = 0;
  });
}

void SampleFormat::mark_nodata(const uint8_t *empty, const PixelBlock &row, int first, int last) const {
  with_sample(type, [&](auto kind) {
    using T = decltype(kind);
    for (int c = first; c < last; ++c) {
      const T nothing = T(nodata_), next = beside_nodata<T>(c);
      T *sample = static_cast<T *>(row.first) + c;
      for (int64_t i = 0; i < row.columns; ++i, sample += channels)
        if (empty[i])
          *sample = nothing;
        else if (equals(*sample, nodata_))
          *sample = next;
    }
  });
}

void SampleFormat::state(double sample, int channel, const PixelBlock &block) const {
  const double span = source_to_[channel] - source_from_[channel];
  const float value = mapped(float((sample - source_from_[channel]) / span), low_[channel], span_[channel]);
  with_sample(type, [&](auto kind) {
    using T = decltype(kind);
    T exact = is_source_ ? T(sample) : stored<T>(value);
    if (has_nodata_ && equals(exact, nodata_)) exact = beside_nodata<T>(channel);
    for (int64_t row = 0; row < block.rows; ++row) {
      T *to = static_cast<T *>(block.first) + row * block.stride + channel;
      for (int64_t i = 0; i < block.columns; ++i, to += channels) *to = exact;
    }
  });
}

}  // namespace sgi
