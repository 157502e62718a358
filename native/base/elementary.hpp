// Elementary functions of floats that decoders compute with (docs/format.md, "Arithmetic"), for V a float or a vector
// of them: products and sums in the order that is written here, so that they are the same numbers everywhere.
#pragma once
#ifdef LANES
#include "base/vector.hpp"
#else
#include "base/scalar.hpp"
#endif

namespace sgi {
namespace {

constexpr float kToWhole = 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer, in the low bits

// 2^x to 3e-7 of itself for x <= 126, exact for whole numbers; 0 below -126. The polynomial has the least greatest
// error of its degree, 7e-8; the rest is rounding.
template <class V>
inline V exp2v(V x) {
  const V most = V{} + 126.0f;
  const auto live = x >= V{} - 126.0f;
  x = x > most ? most : x;
  const V t = x + kToWhole;
  const V f = x - (t - kToWhole);
  V p = V{} + 1.32028596e-3f;
  p = p * f + 9.67495330e-3f;
  p = p * f + 5.55104762e-2f;
  p = p * f + 2.40221664e-1f;
  p = p * f + 6.93146586e-1f;
  p = p * f + 1.0f;
  return select(live, float_of(bits_of(p) + (bits_of(t) << 23)), V{});  // the sum wraps where it is not live
}

// Sine and cosine to about 1e-7 for |x| < 2^13: a quarter turn is taken off in three parts, and polynomials of the
// least greatest error do the rest.
template <class V>
inline void sine_cosine(V x, V &sine, V &cosine) {
  const V t = x * 0.63661977f + kToWhole, turns = t - kToWhole;
  const auto quarter = bits_of(t);
  const V r = ((x - turns * 1.5703125f) - turns * 4.8375129699707031e-4f) - turns * 7.549789948768648e-8f;
  const V rr = r * r;
  V s = V{} - 1.9515295891e-4f;
  s = s * rr + 8.3321608736e-3f;
  s = s * rr - 1.6666654611e-1f;
  s = s * rr * r + r;
  V c = V{} + 2.443315711809948e-5f;
  c = c * rr - 1.388731625493765e-3f;
  c = c * rr + 4.166664568298827e-2f;
  c = c * rr * rr - 0.5f * rr + 1.0f;
  const auto swaps = (quarter & 1) != 0;
  sine = float_of(bits_of(select(swaps, c, s)) ^ ((quarter & 2) << 30));
  cosine = float_of(bits_of(select(swaps, s, c)) ^ (((quarter + 1) & 2) << 30));
}

}  // namespace
}  // namespace sgi
