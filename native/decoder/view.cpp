#include "decoder/view.hpp"

#include <algorithm>
#include <cmath>

namespace sgi {
namespace {

constexpr double kRounding = 1e-9;
constexpr int64_t kOverview = 16;       // pixels of the picture's side for each of its overview's
constexpr int64_t kSmallestSide = 256;  // the last level is the first one whose longer side is no longer

// Half to even.
int64_t rounded(double value) { return std::max<int64_t>(1, int64_t(std::nearbyint(value))); }

struct Span {
  int64_t first, count;
};

Span inner_span(double start, double scale, int64_t count, int64_t size) {
  const auto ceiling = [](double value) { return int64_t(std::ceil(std::clamp(value, -0x1p60, 0x1p60))); };
  const int64_t first = std::max<int64_t>(0, ceiling(-start * scale - 0.5 - kRounding));
  const int64_t end = std::min(count, ceiling((double(size) - start) * scale - 0.5 - kRounding));
  return {first, std::max<int64_t>(0, end - first)};
}

double near_one(double scale) { return std::abs(scale - 1) < kRounding ? 1.0 : scale; }

// Whether `count` output pixels are more than the pixels that they show, rounded up; or one shows less than half a
// pixel.
bool enlarges(int64_t count, double scale) {
  return scale > 2 || double(count) > std::ceil(double(count) / scale - kRounding);
}

}  // namespace

bool PictureView::is_plain() const { return sx == 1 && sy == 1 && std::floor(x) == x && std::floor(y) == y; }

InnerView inner_view(const PictureView &view, int64_t width, int64_t height) {
  const Span across = inner_span(view.x, view.sx, view.columns, width);
  const Span down = inner_span(view.y, view.sy, view.rows, height);
  if (across.count == view.columns && down.count == view.rows) return {view, 0, 0};
  return {{view.x + double(across.first) / view.sx, view.y + double(down.first) / view.sy, view.sx, view.sy,
           across.count, down.count},
          across.first,
          down.first};
}

std::vector<Level> levels_of(int64_t width, int64_t height) {
  std::vector<Level> levels{{width, height, 1.0}};
  while (std::max(levels.back().width, levels.back().height) > kSmallestSide) {
    const double shrink = std::ldexp(1.0, int(levels.size()));
    const int64_t across = rounded(double(width) / shrink), down = rounded(double(height) / shrink);
    levels.push_back({across, down, (double(width) / double(across) + double(height) / double(down)) / 2});
  }
  return levels;
}

Level overview_size(int64_t width, int64_t height) {
  return {rounded(double(width) / kOverview), rounded(double(height) / kOverview), double(kOverview)};
}

std::optional<PictureView> overview_view(int64_t width, int64_t height, const PictureView &view) {
  const Level small = overview_size(width, height);
  if (small.width == width && small.height == height) return std::nullopt;
  const double across = double(small.width) / double(width), down = double(small.height) / double(height);
  const double sx = near_one(view.sx / across), sy = near_one(view.sy / down);
  if (enlarges(view.columns, sx) || enlarges(view.rows, sy)) return std::nullopt;
  return PictureView{view.x * across, view.y * down, sx, sy, view.columns, view.rows};
}

}  // namespace sgi
