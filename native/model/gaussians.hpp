// From seeds to Gaussians and back to gradients (docs/format.md, "Gaussians"), for V a float or a vector of them.
//
// A covariance is h² exp(2 M) + kMinVariance of M = [[a + b, c], [c, a - b]]. What lies beyond kShapeLimit is rendered
// onto it, a and the length of (b, c) by themselves, so that a hostile stream cannot reach infinity.
#pragma once
#include "base/elementary.hpp"
#include "model/constants.hpp"

namespace sgi {
namespace {

template <class V>
struct Shape {
  V a, b, c;
};

// exp(2 M) is even + [[b, c], [c, -b]] odd: even = e^2a cosh 2r, odd = e^2a sinh(2r) / r with r^2 = t = b^2 + c^2.
// `slope` is d odd / d t; d even / d t is odd.
template <class V>
struct SymmetricExp {
  V even, odd, slope;
};

template <class V>
inline SymmetricExp<V> symmetric_exp(V a, V t) {
  constexpr float kLog2e2 = 2 * kLog2e;
  const V scale = exp2v(a * kLog2e2);
  const V safe = maxv(t, V{} + 1e-4f);
  const V r = rootv(safe);
  const V grow = exp2v(r * kLog2e2), fall = 1.0f / grow;
  const V cosh = 0.5f * (grow + fall), sinhc = 0.5f * (grow - fall) / r;
  const auto small = t < 0.02f;  // where differences would cancel: three terms of the series are exact to float32
  const V even = select(small, 1.0f + t * (2.0f + t * (0.6666667f + t * 0.0888889f)), cosh);
  const V odd = select(small, 2.0f + t * (1.3333333f + t * (0.2666667f + t * 0.0253968f)), sinhc);
  const V slope = select(small, 1.3333333f + t * (0.5333333f + t * 0.0761905f), (cosh - 0.5f * sinhc) / safe);
  return {scale * even, scale * odd, scale * slope};
}

// A shape drawn onto its limits: (b, c) times `shrink`.
template <class V>
struct LimitedShape {
  Shape<V> shape;
  V t, shrink;
  decltype(V{} < V{}) is_free;  // (b, c) lies within

  explicit LimitedShape(const Shape<V> &raw) {
    constexpr float kMax = float(kShapeLimit);
    t = raw.b * raw.b + raw.c * raw.c;
    is_free = t < kMax * kMax;
    shrink = select(is_free, V{} + 1.0f, kMax / rootv(maxv(t, V{} + kMax * kMax)));
    shape = {clampv(raw.a, kMax), raw.b * shrink, raw.c * shrink};
  }
  SymmetricExp<V> exp() const { return symmetric_exp(shape.a, minv(t, V{} + float(kShapeLimit * kShapeLimit))); }
};

// `area`: of the cell, pixels².
template <class V>
struct Covariance {
  V area;
  Shape<V> shape;
  SymmetricExp<V> e;

  Covariance(const Shape<V> &raw, V cell_area) : area(cell_area) {
    const LimitedShape<V> limited(raw);
    shape = limited.shape;
    e = limited.exp();
  }
  V xx() const { return area * (e.even + e.odd * shape.b) + float(kMinVariance); }
  V xy() const { return area * e.odd * shape.c; }
  V yy() const { return area * (e.even - e.odd * shape.b) + float(kMinVariance); }
};

// Gradients of the shape from those of its covariance, `up`_xx and so on.
template <class V>
inline Shape<V> shape_gradient(const Shape<V> &raw, V area, V up_xx, V up_xy, V up_yy) {
  constexpr float kMax = float(kShapeLimit);
  const LimitedShape<V> limited(raw);
  const SymmetricExp<V> e = limited.exp();
  const V b = limited.shape.b, c = limited.shape.c;
  const V xx = area * up_xx, xy = area * up_xy, yy = area * up_yy;
  const V even = xx + yy, odd = (xx - yy) * b + xy * c;
  // Along (b, c); on the limit it can only turn, and what would lengthen it is taken out.
  const V along = select(limited.is_free, 2.0f * (even * e.odd + odd * e.slope), odd * e.odd * (-1.0f / (kMax * kMax)));
  return {select(absv(raw.a) < kMax, 2.0f * (even * e.even + odd * e.odd), V{}),
          ((xx - yy) * e.odd + along * b) * limited.shrink, (xy * e.odd + along * c) * limited.shrink};
}

}  // namespace
}  // namespace sgi
