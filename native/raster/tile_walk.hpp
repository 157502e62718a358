// The pixels of a tile that a Gaussian reaches, in vectors of LANES columns. What is visited beyond the ellipse depends
// on LANES; what is drawn of it does not (`Splat`).
#pragma once
#include <type_traits>

#include "base/vector.hpp"
#include "raster/tile_kernel.hpp"

namespace sgi {
namespace {

inline float least(float a, float b) { return a < b ? a : b; }
inline float greatest(float a, float b) { return a > b ? a : b; }

// Rows [first, last) of a tile.
struct Rows {
  int first, last;
};

// The rows in which the Gaussian reaches the LANES columns from dx on; `top` is the tile's first row of pixel centres.
inline Rows rows_of(const Splat &s, float dx, float top) {
  float up = -s.ry, down = s.ry;
  if (dx > -s.rx || dx + (LANES - 1) < s.rx) {
    const float lo = greatest(dx, -s.rx), hi = least(dx + (LANES - 1), s.rx);
    const auto end = [&](float at, float side) {
      const float u = at / s.rx;
      return s.lean * at + side * s.half_height * __builtin_sqrtf(greatest(0.0f, 1.0f - u * u));
    };
    down = end(least(greatest(s.low_dx, lo), hi), 1.0f);
    up = end(least(greatest(-s.low_dx, lo), hi), -1.0f);
  }
  const float from = s.y + up - s.slack - top, to = s.y + down + s.slack - top;
  return {from > 0 ? static_cast<int>(least(from, float(kTileHeight))) + 1 : 0,
          to < kTileHeight - 1 ? static_cast<int>(greatest(to, -1.0f)) + 1 : kTileHeight};
}

// Calls visit(column, dx) for the first column of every vector that a tile needs for the Gaussian; `left` is the tile's
// first column of pixel centres. Where that takes no more vectors, they are aligned.
template <class Visit>
inline __attribute__((always_inline)) void for_each_vector(const Splat &s, float left, Visit visit) {
  const float from = s.x - s.rx - left, to = s.x + s.rx - left;
  int first = from > 0 ? static_cast<int>(least(from, float(kTileWidth))) : 0;
  const int last = to < kTileWidth - 1 ? static_cast<int>(greatest(to, -1.0f)) : kTileWidth - 1;
  const int aligned = first & -LANES;
  if ((last - aligned) / LANES == (last - first) / LANES) first = aligned;
  for (; first <= last; first += LANES) visit(first, left + first - s.x);
}

// Where runs of rows begin: where those of the plane do, or, a little faster, in the first row that is visited.
enum class Runs { kOfPlane, kOfVisit };

// Calls visit(row, dy, G) for every row, from the first one of the plane in which the Gaussian may be on.
template <Runs RUNS, class Visit>
inline __attribute__((always_inline)) void for_each_row(const Splat &s, vf dx, int y0, Rows rows, Visit visit) {
  Heights<vf> heights(s, dx);
  int row = s.first > y0 + rows.first ? s.first - y0 : rows.first;
  for (int into = RUNS == Runs::kOfPlane ? s.into_run(y0 + row) : 0; row < rows.last; into = 0) {
    heights.start(s, y0 + row, into);
    const int end = row + s.span - into, stop = end < rows.last ? end : rows.last;
    for (float dy = float(y0 + row) + 0.5f - s.y; row < stop; ++row, dy += 1.0f) {
      visit(row, dy, heights.g);
      heights.next(s);
    }
  }
}

// The LANES columns of a Gaussian from `column` of the plane on, relative to its centre.
inline vf columns_from(const Splat &s, int column) { return (iota() + float(column) + 0.5f) - s.x; }

// Calls body(c, how many as a constant) for groups of at most four channels that begin at c.
template <int CG = 4, class Body>
inline void for_each_group(int channels, const Body &body, int c = 0) {
  for (; c + CG <= channels; c += CG) body(c, std::integral_constant<int, CG>());
  if constexpr (CG > 1) for_each_group<CG - 1>(channels, body, c);
}

template <int CG>
inline void broadcast(const float *colour, vf (&c)[CG]) {
  for (int k = 0; k < CG; ++k) c[k] = vf{} + colour[k];
}

}  // namespace
}  // namespace sgi
