#include "model/texture_axis.hpp"

#include <algorithm>
#include <cmath>

#include "base/exact.hpp"
#include "model/constants.hpp"

namespace sgi {
namespace {

constexpr double kHalfLog2e = 0x1.71547652b82fep-1;  // 1 / (2 ln 2)
constexpr double kReach = 3.5;                       // deviations of a pixel's footprint that count
constexpr int kSide = 1 << kTextureRoot;
constexpr double kHalfRoot = 0x1.6a09e667f3bcdp-1;  // 1 / sqrt(2): of a separate cell's mean

// Deviation, pixels of the tile, of the Gaussian that stands for what an output pixel covers beyond a pixel.
double deviation(double scale) { return std::sqrt(kPixelVariance * std::max(0.0, 1 - scale * scale)) / scale; }

}  // namespace

double texture_edge(double t, bool hard) {
  if (hard) return t < 0 ? 0.0 : 1.0;
  if (t >= kTextureOverlap) return 1.0;
  return t <= -kTextureOverlap ? 0.0 : sine_pi(0.25 + t / (4 * kTextureOverlap));
}

TextureAxis::TextureAxis(const OutputAxis &output, int64_t length, AxisGrid grid, bool along_pixels,
                         const CellPlaces &places)
    : output_(output), separate_(grid.separate), begin_(-double(grid.before)),
      end_(double(texture_end(length + grid.before) - grid.before)), along_pixels_(along_pixels),
      shared_(output.is_plain()), sigma_(deviation(output.scale)), step_(sigma_ > 0 ? std::min(1.0, sigma_) : 1.0),
      nodes_(std::ceil(kReach * sigma_ / step_)), reach_((separate_ ? 0 : kTextureOverlap) + nodes_ * step_) {
  for (int64_t i = 0; i < output.count; ++i) totals_.push_back(total(output.centre(i)));
  const double begin = output.centre(0) - reach_ - begin_, end = output.centre(output.count - 1) + reach_ - begin_;
  for (int log_size = kTextureLeast; log_size <= kTextureRoot; ++log_size) {
    const double most = std::ceil(std::ldexp(end_ - begin_, -log_size)) - 1;
    const int64_t low = int64_t(std::clamp(std::floor(std::ldexp(begin, -log_size)), 0.0, most + 1));
    const int64_t high = int64_t(std::clamp(std::floor(std::ldexp(end, -log_size)), -1.0, most));
    cells_[log_size - kTextureLeast] = {low, std::vector<CellAxis>(std::max<int64_t>(0, high - low + 1))};
  }
  for (int64_t i = 0; i < places.count; ++i) {
    const int log_size = places.log_size[i];
    Cells &all = cells_[log_size - kTextureLeast];
    const int64_t index = (places.corner[2 * i] >> log_size) - all.first;
    if (index < 0 || index >= int64_t(all.axes.size()) || all.axes[index].stride) continue;
    all.axes[index] = cell_axis(index + all.first, log_size);
  }
}

CellAxis TextureAxis::cell_axis(int64_t index, int log_size) {
  const int side = 1 << log_size;
  const double begin = begin_ + double(index * side), end = begin + side;
  const Edges edges{begin, side, separate_ || index == 0, separate_ || end == end_, end == end_};
  const double spread = nodes_ * step_;
  const auto pixel = [&](double x) { return output_.pixel_at(x) - 0.5; };
  const double low = std::ceil(pixel(begin - (edges.hard_low ? spread : reach_)));
  const double high = std::floor(pixel(end + (edges.hard_high ? spread : reach_))) + 1;
  const double first = std::clamp(low, 0.0, double(output_.count));
  const int64_t count = std::max<int64_t>(0, int64_t(std::clamp(high, 0.0, double(output_.count)) - first));
  CellAxis axis{int64_t(first), count, int64_t(values_.size()), side};
  if (count == 0) return axis;
  if (!shared_) {
    axis.stride = write_table(edges, axis.first, count);
    return axis;
  }
  const int64_t whole = int64_t(high - low);
  Shared &table = tables_[log_size - kTextureLeast][edges.hard_low + 2 * edges.hard_high];
  if (table.at < 0) table = {int64_t(values_.size()), write_table(edges, int64_t(low), whole)};
  axis.stride = table.stride;
  axis.at = table.at + (axis.first - int64_t(low)) * (along_pixels_ ? 1 : side);
  return axis;
}

// What a pixel sees of a place `offset` from its centre, not normalised.
double TextureAxis::weight(double offset) const {
  return sigma_ > 0 ? exp2_of(-kHalfLog2e * (offset / sigma_) * (offset / sigma_)) : 1.0;
}

// The first and last of the places, `step_` apart around a pixel's centre, between `low` and `high`.
std::pair<double, double> TextureAxis::seen(double middle, double low, double high) const {
  return {std::max(-nodes_, std::ceil((low - middle) / step_)), std::min(nodes_, std::floor((high - middle) / step_))};
}

// The weights of all places where cells are.
double TextureAxis::total(double middle) const {
  const auto [first, last] = seen(middle, begin_, end_);
  double sum = 0;
  for (double i = first; i <= last; ++i) sum += weight(i * step_);
  return sum;
}

// cos((k + p) a) obeys c(k + 1) = 2 cos(a) c(k) - c(k - 1), with p = 0 in separate cells and 1/2 else.
int64_t TextureAxis::write_table(const Edges &edges, int64_t first, int64_t count) {
  const int side = edges.side;
  const double low = edges.begin - (edges.hard_low ? 0 : kTextureOverlap);
  // A table that cells share is that of one that ends inside: of one that does not, what lies behind is not rendered.
  const double last = edges.begin + side + (edges.hard_high ? 0 : kTextureOverlap),
               high = shared_ ? last : std::min(last, end_);
  const int64_t at = int64_t(values_.size()), stride = along_pixels_ ? count + kTexturePadding : side;
  values_.resize(at + (along_pixels_ ? side : count) * stride);
  for (int64_t i = 0; i < count; ++i) {
    const double middle = output_.centre(first + i);
    double sums[kSide] = {};
    const auto [from, to] = seen(middle, low, high);
    for (double node = from; node <= to; ++node) {
      const double t = middle + node * step_ - edges.begin, cosine = cosine_pi(t / side), twice = 2 * cosine;
      if (separate_ && !edges.is_last && t >= side) continue;  // the next cell's
      const double window =
          texture_edge(t, edges.hard_low) * texture_edge(side - t, edges.hard_high) * weight(node * step_);
      double now = separate_ ? window : cosine_pi(0.5 * t / side) * window, before = separate_ ? cosine * window : now;
      for (int k = 0; k < side; ++k) {
        sums[k] += now;
        const double next = twice * now - before;
        before = now;
        now = next;
      }
    }
    if (separate_) sums[0] *= kHalfRoot;
    const double gain = from <= to ? std::sqrt(2.0 / side) / (shared_ ? 1.0 : totals_[first + i]) : 0.0;
    for (int k = 0; k < side; ++k)
      values_[at + (along_pixels_ ? k * stride + i : i * stride + k)] = float(sums[k] * gain);
  }
  return stride;
}

}  // namespace sgi
