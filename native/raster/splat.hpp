// A Gaussian as tiles need it, and what they say of it.
#pragma once
#include <cstdint>

namespace sgi {

// A Gaussian ready to be drawn: log2 G(d) = a dx^2 + b dx dy + c dy^2.
struct Splat {
  float x, y;         // centre, pixels
  float a, b, c;      // log2 units per pixel^2
  float k;            // 2^(2c): second ratio of consecutive rows
  float rx, ry;       // half extents: what lies farther away contributes nothing
  float lean;         // dy of the axis of heights per dx
  float half_height;  // half height at the centre column
  float low_dx;       // dx at which the lower end is reached
  int32_t span;       // rows that the recurrence may run before it must start afresh, at least 1
};

// Moments of one pair: sums over the tile's pixels of w, w dx, w dx^2, w dy, w dx dy, w dy^2 (w = G <dL/dI, colour>),
// followed by sums of G dL/dI per channel.
constexpr int kMoments = 6;

}  // namespace sgi
