#include "metrics/colour_pyramid.hpp"

#include <algorithm>

#include "base/thread_pool.hpp"

namespace sgi {

std::vector<MapPlane> visual_scales(int64_t height, int64_t width) {
  std::vector<MapPlane> scales;
  while (scales.size() < kVisualScales && std::min(height, width) >= kSmallestScale) {
    scales.push_back({width, height});
    height = (height + 1) / 2;
    width = (width + 1) / 2;
  }
  return scales;
}

ColourPyramid::ColourPyramid(const SrgbPicture &picture, const ColourPyramid *less, int threads,
                             const ColourKernel &kernel)
    : kernel_(kernel), colours_(picture.colours()) {
  for (const MapPlane &plane : visual_scales(picture.height, picture.width)) {
    Scale scale{plane, {}, {}};
    const int64_t size = plane.height * padded(plane.width);
    for (Floats &xyb : scale.xyb) xyb = floats(size);
    for (int c = 0; !scales_.empty() && c < colours_; ++c) scale.linear[c] = floats(size);
    scales_.push_back(std::move(scale));
  }
  for (size_t scale = 0; scale < scales_.size(); ++scale)
    parallel_for(bands_of(scales_[scale].plane.height), threads,
                 [&](int64_t band) { convert_band(picture, less, scale, band); });
}

void ColourPyramid::keep_xyb() {
  for (Scale &scale : scales_) scale.linear = {};
}

void ColourPyramid::convert_band(const SrgbPicture &picture, const ColourPyramid *less, size_t scale, int64_t band) {
  const auto [width, height] = scales_[scale].plane;
  const int64_t stride = padded(width), end = std::min(height, (band + 1) * kBandRows);
  const Floats rows = floats(2 * colours_ * stride);  // two rows of each colour, if none are in memory
  for (int64_t y = band * kBandRows; y < end; y += 2) {
    const int count = y + 1 < end ? 2 : 1;
    const float *linear[2][kVisualChannels];
    for (int i = 0; i < count; ++i) {
      for (int c = 0; c < colours_; ++c) {
        float *row = scale ? scales_[scale].linear[c].get() + (y + i) * stride : rows.get() + (2 * c + i) * stride;
        if (!scale) kernel_.linearize(picture.row(c, y + i), width, row);
        linear[i][c] = row;
      }
      std::fill(linear[i] + colours_, linear[i] + kVisualChannels, linear[i][0]);
      const float *other[kVisualChannels];
      float *xyb[kVisualChannels];
      for (int c = 0; c < kVisualChannels; ++c) {
        if (less) other[c] = less->xyb(scale, c) + (y + i) * stride;
        xyb[c] = scales_[scale].xyb[c].get() + (y + i) * stride;
      }
      kernel_.to_xyb(linear[i], less ? other : nullptr, width, xyb);
    }
    for (int c = 0; scale + 1 < scales_.size() && c < colours_; ++c) {
      Scale &next = scales_[scale + 1];
      kernel_.halve(linear[0][c], count == 2 ? linear[1][c] : nullptr, width,
                    next.linear[c].get() + y / 2 * padded(next.plane.width));
    }
  }
}

void ColourPyramid::pull_row(const ColourPyramid &reference, size_t scale, int64_t y, const float *const gradient[3],
                             float *rows, const SrgbPicture &picture, float *out) {
  const auto [width, height] = scales_[scale].plane;
  const int64_t stride = padded(width);
  const float *original[kVisualChannels], *difference[kVisualChannels];
  float *linear[kVisualChannels];
  for (int c = 0; c < kVisualChannels; ++c) {
    original[c] = reference.xyb(scale, c) + y * stride;
    difference[c] = xyb(scale, c) + y * stride;
    linear[c] = scale && colours_ > 1 ? scales_[scale].linear[c].get() + y * stride : rows + c * stride;
  }
  kernel_.to_linear_gradient(original, difference, gradient, width, linear);
  if (colours_ == 1) {  // all three are of one gray
    float *gray = scale ? scales_[scale].linear[0].get() + y * stride : rows;
    for (int64_t x = 0; x < width; ++x) gray[x] = linear[0][x] + linear[1][x] + linear[2][x];
    linear[0] = gray;
  }
  for (int c = 0; c < colours_; ++c) {
    if (scale + 1 < scales_.size()) {
      const Scale &next = scales_[scale + 1];
      kernel_.add_doubled(next.linear[c].get() + y / 2 * padded(next.plane.width), y / 2 * 2 + 1 < height ? 2 : 1,
                          width, linear[c]);
    }
    if (!scale) kernel_.to_sample_gradient(picture.row(c, y), linear[c], width, out + (c * height + y) * width);
  }
}

}  // namespace sgi
