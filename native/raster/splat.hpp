// A Gaussian as tiles need it, and its heights. On a GPU, too.
#pragma once
#include <cstdint>

#include "base/elementary.hpp"

namespace sgi {

// What the heights of a Gaussian follow from: log2 G(dx, dy) = across dx^2 + down (dy - lean dx)^2.
//
// Along a column, heights obey a recurrence: G(y + 1) = G(y) r(y), r(y + 1) = r(y) ratio. Runs of `span` rows start
// afresh, the first of them in row `first` of the plane, so that a height depends on the pixel alone: not on the part
// of the picture that is drawn, nor on the width of vectors (docs/format.md, "Heights").
struct Bell {
  float x, y;           // centre, pixels
  float across, down;   // log2 units per pixel^2
  float lean;           // dy of the ridge per dx
  float ratio;          // 2^(2 down)
  int32_t first, span;  // row of the plane; rows of a run: 1, 2, 4 or 8

  // Rows between the beginning of its run and a row.
  int into_run(int row) const { return (row - first) & (span - 1); }
};

// A Gaussian, and where its pixels are looked at: none outside is as high as the least height.
struct Splat : Bell {
  float rx, ry;       // half extents, pixels
  float half_height;  // at the centre column
  float low_dx;       // dx at which the lower end is reached
  float slack;        // pixels that rounding may take
};

// Moments of one pair: sums over the tile's pixels of w, w dx, w dx^2, w dy, w dx dy, w dy^2 (w = G <dL/dI, colour>),
// followed by sums of G dL/dI per channel.
constexpr int kMoments = 6;

namespace {

// The heights of a Gaussian in the columns dx from its centre, for V a float or a vector of them.
template <class V>
struct Heights {
  V ridge, side, g, r;

  Heights(const Bell &b, V dx) : ridge(b.lean * dx), side(b.across * dx * dx), g(), r() {}
  // Those of the row of the plane in which a run starts.
  void start(const Bell &b, int row) {
    const V t = (float(row) + 0.5f - b.y) - ridge;
    g = exp2v(side + b.down * t * t);
    r = exp2v(b.down * (2.0f * t + 1.0f));
  }
  // Those of a row that is `into` rows into its run.
  void start(const Bell &b, int row, int into) {
    start(b, row - into);
    for (int i = 0; i < into; ++i) next(b);
  }
  void next(const Bell &b) {
    g *= r;
    r *= b.ratio;
  }
};

// What a Gaussian's heights are at least where it is drawn: that of a point `cutoff` deviations from the centre.
inline float least_height(float cutoff) { return exp2v(-0.5f * kLog2e * cutoff * cutoff); }

}  // namespace
}  // namespace sgi
