// A plane of floats in a border of zeros, which filters read beyond its sides.
#pragma once
#include <algorithm>

#include "metrics/colour_pyramid.hpp"
#include "metrics/maps.hpp"

namespace sgi {

constexpr int64_t kBorder = 16;  // rows and columns on each side

// Values are unset at first; columns from the width up to padded(width) belong to the border.
class BorderedPlane {
 public:
  BorderedPlane() = default;
  explicit BorderedPlane(MapPlane size) : size_(size), stride_(stride_of(size.width)), memory_(floats(count())) {
    clear_border();
  }

  static int64_t stride_of(int64_t width) { return padded(width) + 2 * kBorder; }
  MapPlane size() const { return size_; }
  int64_t stride() const { return stride_; }
  float *row(int64_t y) { return memory_.get() + (y + kBorder) * stride_ + kBorder; }
  const float *row(int64_t y) const { return memory_.get() + (y + kBorder) * stride_ + kBorder; }

  void clear() { std::fill_n(memory_.get(), count(), 0.0f); }

  // Makes the nearest rows and columns of the border mirror those inside, the outermost included.
  void mirror_border(int64_t reach) {
    const auto [width, height] = size_;
    for (int64_t y = 0; y < height; ++y)
      for (int64_t i = 0; i < reach; ++i) row(y)[-1 - i] = row(y)[i], row(y)[width + i] = row(y)[width - 1 - i];
    for (int64_t i = 0; i < reach; ++i) {
      std::copy_n(row(i) - reach, width + 2 * reach, row(-1 - i) - reach);
      std::copy_n(row(height - 1 - i) - reach, width + 2 * reach, row(height + i) - reach);
    }
  }

 private:
  void clear_border() {
    std::fill_n(memory_.get(), kBorder * stride_, 0.0f);
    for (int64_t y = 0; y < size_.height; ++y) {
      std::fill_n(row(y) - kBorder, kBorder, 0.0f);
      std::fill_n(row(y) + size_.width, padded(size_.width) - size_.width + kBorder, 0.0f);
    }
    std::fill_n(row(size_.height) - kBorder, kBorder * stride_, 0.0f);
  }

  int64_t count() const { return (size_.height + 2 * kBorder) * stride_; }

  MapPlane size_{0, 0};
  int64_t stride_ = 0;
  Floats memory_;
};

}  // namespace sgi
