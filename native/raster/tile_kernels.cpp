// The tile kernel, written once over vectors of LANES floats (compiler vector extensions).
//
// Along a column, G obeys a second-order recurrence: G(y+1) = G(y) r(y), r(y+1) = r(y) k with k = 2^(2c) constant.
// Two exponentials per lane start a column, then two products per row replace the exponential of every pixel.
// `Splat::span` bounds the rows between fresh starts so that a start value never underflows where it later matters.
#include "base/horizontal_sums.hpp"
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
  const float from = s.y + up - top, to = s.y + down - top;
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

// Calls visit(row, dy, G) for every row; `dx` is where the lanes lie from the Gaussian's centre.
template <class Visit>
inline __attribute__((always_inline)) void for_each_row(const Splat &s, vf dx, float top, Rows rows, Visit visit) {
  const vf quad = s.a * dx * dx;
  const vf slope = s.b * dx;
  const vf kk = vf{} + s.k;
  for (int row = rows.first; row < rows.last;) {
    float dy = top + row - s.y;
    vf g = exp2v(quad + (slope + s.c * dy) * dy);
    vf r = exp2v(slope + s.c * (2.0f * dy + 1.0f));
    const int stop = row + s.span < rows.last ? row + s.span : rows.last;
    for (; row < stop; ++row) {
      visit(row, dy, g);
      g *= r;
      r *= kk;
      dy += 1.0f;
    }
  }
}

template <int CG>
inline void broadcast(const float *colour, vf (&c)[CG]) {
  for (int k = 0; k < CG; ++k) c[k] = vf{} + colour[k];
}

template <int CG>
void forward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                   int y0, float *tile) {
  const float left = x0 + 0.5f, top = y0 + 0.5f;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    vf c[CG];
    broadcast(colours + int64_t(entries[i].gaussian) * channels, c);
    for_each_vector(s, left, [&](int column, float dx) {
      for_each_row(s, iota() + dx, top, rows_of(s, dx, top), [&](int row, float, vf g) {
        float *at = tile + row * kTileStride + column;
#pragma GCC unroll 4
        for (int k = 0; k < CG; ++k) store(at + k * kTilePlane, load(at + k * kTilePlane) + g * c[k]);
      });
    });
  }
}

template <int CG>
void backward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int c0,
                    int x0, int y0, const float *grad, float *partials) {
  const float left = x0 + 0.5f, top = y0 + 0.5f;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    vf c[CG], all[kMoments + CG] = {};
    broadcast(colours + int64_t(entries[i].gaussian) * channels + c0, c);
    for_each_vector(s, left, [&](int column, float first_dx) {
      const vf dx = iota() + first_dx;
      vf w{}, wy{}, wyy{};
      for_each_row(s, dx, top, rows_of(s, first_dx, top), [&](int row, float dy, vf g) {
        const float *at = grad + row * kTileStride + column;
        vf t{};
#pragma GCC unroll 4
        for (int k = 0; k < CG; ++k) {
          const vf up = load(at + k * kTilePlane);
          t = k ? t + up * c[k] : up * c[k];
          all[kMoments + k] += g * up;
        }
        const vf m = g * t;
        w += m;
        wy += m * dy;
        wyy += m * (dy * dy);
      });
      all[0] += w;
      all[1] += w * dx;
      all[2] += w * dx * dx;
      all[3] += wy;
      all[4] += wy * dx;
      all[5] += wyy;
    });
    float sum[kMoments + CG] = {};
    add_sums<kMoments + CG>(all, sum);
    float *out = partials + int64_t(entries[i].slot) * (kMoments + channels);
    for (int j = 0; j < kMoments; ++j) out[j] = c0 == 0 ? sum[j] : out[j] + sum[j];
    for (int k = 0; k < CG; ++k) out[kMoments + c0 + k] = sum[kMoments + k];
  }
}

void forward(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
             float *tile) {
  for (int c = 0; c < channels;) {
    const int left = channels - c;
    float *out = tile + c * kTilePlane;
    const float *from = colours + c;
    switch (left) {
      case 1:
        forward_group<1>(entries, n, splats, from, channels, x0, y0, out);
        c += 1;
        break;
      case 2:
        forward_group<2>(entries, n, splats, from, channels, x0, y0, out);
        c += 2;
        break;
      case 3:
        forward_group<3>(entries, n, splats, from, channels, x0, y0, out);
        c += 3;
        break;
      default:
        forward_group<4>(entries, n, splats, from, channels, x0, y0, out);
        c += 4;
        break;
    }
  }
}

void backward(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
              const float *grad, float *partials) {
  for (int c = 0; c < channels;) {
    const int left = channels - c;
    const float *from = grad + c * kTilePlane;
    switch (left) {
      case 1:
        backward_group<1>(entries, n, splats, colours, channels, c, x0, y0, from, partials);
        c += 1;
        break;
      case 2:
        backward_group<2>(entries, n, splats, colours, channels, c, x0, y0, from, partials);
        c += 2;
        break;
      case 3:
        backward_group<3>(entries, n, splats, colours, channels, c, x0, y0, from, partials);
        c += 3;
        break;
      default:
        backward_group<4>(entries, n, splats, colours, channels, c, x0, y0, from, partials);
        c += 4;
        break;
    }
  }
}

// Clears what of a row of a tile lies outside the view; the part inside is [begin, end).
inline void clear_outside(float *row, int begin, int end) {
  for (int x = 0; x < begin; ++x) row[x] = 0.0f;
  for (int x = end; x < kTileStride; ++x) row[x] = 0.0f;
}

template <Loss LOSS, bool WEIGHTED>
Errors compare_as(float *tile, int channels, const TileRect &r, const Comparison &with, int64_t width, int64_t height) {
  constexpr bool kSquared = LOSS == Loss::kSquared;
  const float weight = kSquared ? 2.0f * with.weight : with.weight;
  Errors total{};
  for (int c = 0; c < channels; ++c) {
    vf loss{}, squared{};
    for (int y = 0; y < kTileHeight; ++y) {
      float *row = tile + c * kTilePlane + y * kTileStride;
      const bool inside = y >= r.row0 && y < r.row1;
      const int begin = inside ? r.col0 : kTileStride, end = inside ? r.col1 : kTileStride;
      clear_outside(row, begin, end);
      if (!inside) continue;
      const float *wanted = with.target + (c * height + r.y + y) * width + r.x;
      const float *w = WEIGHTED ? with.weights + (r.y + y) * width + r.x : nullptr;
      int x = begin;
      for (; x + LANES <= end; x += LANES) {
        const vf error = load(row + x) - load(wanted + x), size = kSquared ? error : absv(error);
        squared += error * error;
        const vf slope = kSquared ? error : signv(error);
        if constexpr (WEIGHTED) {
          const vf scaled = load(w + x) * size;
          loss += kSquared ? scaled * error : scaled;
          store(row + x, weight * (load(w + x) * slope));
        } else {
          if constexpr (!kSquared) loss += size;
          store(row + x, weight * slope);
        }
      }
      float rest = 0, rest_squared = 0;
      for (; x < end; ++x) {
        const float error = row[x] - wanted[x], own = WEIGHTED ? w[x] : 1.0f;
        rest_squared += error * error;
        rest += own * (kSquared ? error * error : absv(error));
        row[x] = weight * (own * (kSquared ? error : signv(error)));
      }
      total.squared += rest_squared;
      total.loss += rest;
    }
    for (int i = 0; i < LANES; ++i) {
      total.squared += squared[i];
      total.loss += loss[i];
    }
  }
  if (kSquared && !WEIGHTED) total.loss = total.squared;
  return total;
}

Errors compare(float *tile, int channels, const TileRect &r, const Comparison &with, int64_t width, int64_t height) {
  if (with.loss == Loss::kSquared)
    return (with.weights ? compare_as<Loss::kSquared, true> : compare_as<Loss::kSquared, false>)(tile, channels, r,
                                                                                                 with, width, height);
  return (with.weights ? compare_as<Loss::kAbsolute, true> : compare_as<Loss::kAbsolute, false>)(tile, channels, r,
                                                                                                 with, width, height);
}

}  // namespace

const TileKernel TileKernel::SGI_ISA{sgi::forward, sgi::compare, sgi::backward};

}  // namespace sgi
