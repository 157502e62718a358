// The ellipse in which a Gaussian is drawn, and the tiles that it touches. Without the standard library's templates:
// this runs on a GPU, too.
#pragma once
#include <cstdint>

#include "raster/splat.hpp"

namespace sgi {

// A crop of the plane in whole pixels. Tiles are anchored to the plane, not to the crop, so that a crop of a picture
// equals the picture's crop to the last bit.
template <int WIDTH, int HEIGHT>
struct TiledView {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  int tile_x0() const { return floor_div(x0, WIDTH); }
  int tile_y0() const { return floor_div(y0, HEIGHT); }
  int tiles_x() const { return floor_div(x0 + width - 1, WIDTH) - tile_x0() + 1; }
  int tiles_y() const { return floor_div(y0 + height - 1, HEIGHT) - tile_y0() + 1; }
  bool operator==(const TiledView &o) const {
    return x0 == o.x0 && y0 == o.y0 && width == o.width && height == o.height;
  }
  static int floor_div(int v, int by) { return v >= 0 ? v / by : -((-v + by - 1) / by); }
};

namespace {

constexpr int kLongestSpan = 8;  // rows; rounding errors grow with the square

// Pixels are looked at a little farther out than the cutoff is. Rounding of heights never takes as much: relative to
// the largest of them, |log2 G| of a point at r deviations is computed to 2e-7 r^2 sqrt(xx yy / det) + 1e-5, which is
// 0.003 at kThinnest.
constexpr float kReach = 1.002f;
constexpr double kThinnest = 1e-6;  // of det / (xx yy), below which covariances of 24 bits say nothing

// The ellipse in which pixels are looked at, relative to the centre.
struct Ellipse {
  float ry;          // half height
  float lean;        // dx of the axis of widths per dy
  float half_width;  // half width at the centre row
  float top_dy;      // dy at which the right end is reached
  float slack;       // pixels beyond the ends

  // Right and left end of the part with dy in [lo, hi].
  void extent(float lo, float hi, float &left, float &right) const {
    right = edge(within(top_dy, lo, hi), 1.0f) + slack;
    left = edge(within(-top_dy, lo, hi), -1.0f) - slack;
  }

 private:
  float within(float dy, float lo, float hi) const { return minv(maxv(dy, maxv(lo, -ry)), minv(hi, ry)); }
  float edge(float dy, float side) const {
    const float u = dy / ry;
    return lean * dy + side * half_width * rootv(maxv(0.0f, 1.0f - u * u));
  }
};

// Prepares one Gaussian: mean [2] pixels, covariance [3] (xx, xy, yy) pixels^2. False for one that is not drawn.
inline bool prepare(const float *mean, const float *cov, float cutoff, Splat &s, Ellipse &e) {
  const double xx = cov[0], xy = cov[1], yy = cov[2];
  const double det = xx * yy - xy * xy;
  if (!(xx > 0 && yy > 0 && det > kThinnest * xx * yy) || !is_finite(det) || !is_finite(mean[0]) || !is_finite(mean[1]))
    return false;
  s.x = mean[0];
  s.y = mean[1];
  s.across = static_cast<float>(-0.5 * kLog2e / xx);
  s.down = static_cast<float>(-0.5 * kLog2e * xx / det);
  s.lean = static_cast<float>(xy / xx);
  s.ratio = exp2v(2.0f * s.down);
  s.first = static_cast<int32_t>(floorv(clampv(s.y - cutoff * rootv(cov[2]) + 0.5f, 1e9f)));
  // A start must not underflow (2^-126) if a later row of its run lies within the cutoff, 2^-(0.85 cutoff)^2: over
  // span - 1 rows sqrt(-log2 G) falls by at most sqrt(-down) (span - 1).
  const float headroom = maxv(0.0f, 11.2f - 0.85f * cutoff), fall = rootv(-s.down);
  s.span = kLongestSpan;
  while (s.span > 1 && float(s.span - 1) * fall > headroom) s.span /= 2;

  const float reach = cutoff * kReach;
  s.slack = e.slack = 0.01f + 0x1p-21f * (absv(s.x) + absv(s.y));
  s.rx = reach * rootv(cov[0]) + s.slack;
  s.ry = reach * rootv(cov[2]) + s.slack;
  s.half_height = static_cast<float>(reach * rootv(det / xx));
  s.low_dx = static_cast<float>(reach * xy / rootv(yy));
  e.ry = s.ry;
  e.lean = static_cast<float>(xy / yy);
  e.half_width = static_cast<float>(reach * rootv(det / yy));
  e.top_dy = static_cast<float>(reach * xy / rootv(xx));
  return true;
}

// Calls visit(tile) for every tile of the view that the ellipse touches, in row-major order.
template <int WIDTH, int HEIGHT, class Visit>
void for_each_tile(const Splat &s, const Ellipse &e, const TiledView<WIDTH, HEIGHT> &view, Visit visit) {
  const int tx0 = view.tile_x0(), ty0 = view.tile_y0(), nx = view.tiles_x(), ny = view.tiles_y();
  // Pixel centres sit at +1/2: a tile covers centres from 1/2 to its size less 1/2.
  const auto first_tile = [](float edge, int size, int base) {
    return static_cast<int>(floorv((clampv(edge, 1e8f) - (size - 0.5f)) / size + 1.0f)) - base;
  };
  const auto last_tile = [](float edge, int size, int base) {
    return static_cast<int>(floorv((clampv(edge, 1e8f) - 0.5f) / size)) - base;
  };
  const auto greater = [](int a, int b) { return a > b ? a : b; };
  const auto less = [](int a, int b) { return a < b ? a : b; };
  const int row0 = greater(0, first_tile(s.y - e.ry, HEIGHT, ty0));
  const int row1 = less(ny - 1, last_tile(s.y + e.ry, HEIGHT, ty0));
  for (int row = row0; row <= row1; ++row) {
    const float lo = (ty0 + row) * float(HEIGHT) + 0.5f - s.y;
    float left, right;
    e.extent(lo, lo + (HEIGHT - 1), left, right);
    const int col0 = greater(0, first_tile(s.x + left, WIDTH, tx0));
    const int col1 = less(nx - 1, last_tile(s.x + right, WIDTH, tx0));
    for (int col = col0; col <= col1; ++col) visit(static_cast<uint32_t>(row * nx + col));
  }
}

}  // namespace
}  // namespace sgi
