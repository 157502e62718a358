#include "image/halve.hpp"

#include <algorithm>
#include <vector>

namespace sgi {

namespace {

float filtered(float before, float first, float second, float after) {
  return 0.125f * (before + after) + 0.375f * (first + second);
}

}  // namespace

void halve(const float *planes, int64_t channels, int64_t height, int64_t width, float *half) {
  const int64_t rows = (height + 1) / 2, columns = (width + 1) / 2;
  std::vector<float> line(size_t(2 * columns + 2));  // a row of half the height, with its edges repeated
  for (int64_t at = 0; at < channels * rows; ++at) {
    const float *plane = planes + at / rows * height * width;
    const int64_t y = 2 * (at % rows);
    const auto row = [&](int64_t i) { return plane + std::clamp(i, int64_t(0), height - 1) * width; };
    const float *before = row(y - 1), *first = row(y), *second = row(y + 1), *after = row(y + 2);
    float *inside = &line[1];
    for (int64_t x = 0; x < width; ++x) inside[x] = filtered(before[x], first[x], second[x], after[x]);
    line[0] = inside[0];
    std::fill(inside + width, line.data() + line.size(), inside[width - 1]);
    float *out = half + at * columns;
    for (int64_t x = 0; x < columns; ++x) {
      const float *p = &line[size_t(2 * x)];
      out[x] = filtered(p[0], p[1], p[2], p[3]);
    }
  }
}

}  // namespace sgi
