#include "metrics/plane_blur.hpp"

#include <cmath>

#include "metrics/bands.hpp"

namespace sgi {
namespace {

// 1 / the share of a symmetric filter's taps that lies within a side, for each place on it; 1 in a border.
std::vector<float> inverse_shares(const std::vector<float> &taps, int64_t side) {
  std::vector<float> found(size_t(BorderedPlane::stride_of(side)), 1.0f);
  const int64_t reach = int64_t(taps.size()) - 1;
  for (int64_t i = 0; i < side; ++i) {
    double share = 0;
    for (int64_t j = std::max<int64_t>(i - reach, 0); j <= std::min(i + reach, side - 1); ++j)
      share += double(taps[size_t(std::abs(j - i))]);
    found[size_t(kBorder + i)] = float(1 / share);
  }
  return found;
}

}  // namespace

PlaneBlur::PlaneBlur(double sigma, MapPlane size, BlurBorder border, int threads, Isa isa)
    : size_(size), threads_(threads), kernel_(kernel_for<PlaneBlurKernel>(isa)),
      taps_(size_t(std::max(1, int(2.25 * sigma))) + 1) {
  double sum = 0;
  const auto weight = [&](int i) { return std::exp(-i * i / (2 * sigma * sigma)); };
  for (int i = -reach(); i <= reach(); ++i) sum += weight(i);
  for (int i = 0; i <= reach(); ++i) taps_[size_t(i)] = float(weight(i) / sum);
  const auto ones = [](int64_t side) { return std::vector<float>(size_t(BorderedPlane::stride_of(side)), 1.0f); };
  ones_ = ones(size.width);
  const bool shares = border == BlurBorder::kNone;
  rows_ = shares ? inverse_shares(taps_, size.height) : ones(size.height);
  columns_ = shares ? inverse_shares(taps_, size.width) : ones_;
}

void PlaneBlur::blur(const BorderedPlane &from, BorderedPlane &to) const {
  for (int64_t y = 0; y < size_.height; ++y) std::fill_n(to.row(y), size_.width, 0.0f);
  run(from, to, false);
}

void PlaneBlur::pull(const BorderedPlane &gradient, BorderedPlane &to) const { run(gradient, to, true); }

void PlaneBlur::run(const BorderedPlane &from, BorderedPlane &to, bool transposed) const {
  const float *const columns = columns_.data() + kBorder, *const ones = ones_.data() + kBorder;
  each_band(size_.height, threads_, [&](int64_t, int64_t begin, int64_t end) {
    const Floats scratch = floats(from.stride());
    std::vector<float> down(size_t(2 * reach() + 1));
    for (int64_t y = begin; y < end; ++y) {
      for (int i = -reach(); i <= reach(); ++i) {
        const int64_t counted = std::clamp<int64_t>(transposed ? y + i : y, 0, size_.height - 1);
        down[size_t(i + reach())] = taps_[size_t(std::abs(i))] * rows_[size_t(kBorder + counted)];
      }
      kernel_.add(from.row(y), from.stride(), size_.width, reach(), down.data(), taps_.data(),
                  transposed ? columns : ones, transposed ? ones : columns, to.row(y), scratch.get());
    }
  });
}

}  // namespace sgi
