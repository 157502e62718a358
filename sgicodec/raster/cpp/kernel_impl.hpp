// The tile kernel, written once over vectors of LANES floats (compiler vector extensions) and included by one
// translation unit per instruction set, each in its own unnamed namespace.
//
// Along a column, G obeys a second-order recurrence: G(y+1) = G(y) r(y), r(y+1) = r(y) k with k = 2^(2c) constant.
// Two exponentials per lane start a column, then two products per row replace the exponential of every pixel.
// `Splat::span` bounds the rows between fresh starts so that a start value never underflows where it later matters.
#include <utility>

#include "kernel.hpp"
#include "vector.hpp"

namespace sgi {
namespace {

// Whether LANES columns from x on (relative to the centre) lie beside the Gaussian.
inline bool beside(const Splat &s, float x) { return LANES < kTile && (x > s.rx || x + (LANES - 1) < -s.rx); }

// Calls visit(row, G) for every row of a tile that the Gaussian reaches; `dx` is where the lanes lie from its centre,
// `top` the tile's first row of pixel centres.
template <class Visit>
inline __attribute__((always_inline)) void for_each_row(const Splat &s, vf dx, float top, Visit visit) {
  const float from = s.y - s.ry - top, to = s.y + s.ry - top;
  const int first = from > 0 ? static_cast<int>(from) + 1 : 0;
  const int last = to < kTile - 1 ? static_cast<int>(to) + 1 : kTile;
  const vf quad = s.a * dx * dx;
  const vf slope = s.b * dx;
  const vf kk = vf{} + s.k;
  for (int row = first; row < last;) {
    const float dy = top + row - s.y;
    vf g = exp2v(quad + (slope + s.c * dy) * dy);
    vf r = exp2v(slope + s.c * (2.0f * dy + 1.0f));
    const int stop = row + s.span < last ? row + s.span : last;
    for (; row < stop; ++row) {
      visit(row, g);
      g *= r;
      r *= kk;
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
  for (int bx = 0; bx < kTile; bx += LANES) {
    vf sum[kTile][CG] = {};
    for (int64_t i = 0; i < n; ++i) {
      const Splat &s = splats[entries[i].gaussian];
      const float left = x0 + bx + 0.5f - s.x;
      if (beside(s, left)) continue;
      vf c[CG];
      broadcast(colours + int64_t(entries[i].gaussian) * channels, c);
      for_each_row(s, iota() + left, y0 + 0.5f, [&](int row, vf g) {
#pragma GCC unroll 4
        for (int k = 0; k < CG; ++k) sum[row][k] += g * c[k];
      });
    }
    for (int k = 0; k < CG; ++k)
      for (int row = 0; row < kTile; ++row) {
        float *p = tile + k * kTilePixels + row * kTile + bx;
        store(p, load(p) + sum[row][k]);
      }
  }
}

// Where element `i` of merge's first (ODD = 0) or second operand comes from among a's elements followed by b's.
template <int UNIT, int SPAN>
constexpr int32_t merge_index(int i, int odd) {
  constexpr int HALF = SPAN / UNIT / 2;
  const int unit = i % SPAN / UNIT;
  return (unit < HALF ? 0 : LANES) + i / SPAN * SPAN + (unit % HALF * 2 + odd) * UNIT + i % UNIT;
}

// Adds neighbouring units of UNIT lanes: each SPAN of the result holds those of a, then those of b.
template <int UNIT, int SPAN, size_t... I>
inline vf merge(vf a, vf b, std::index_sequence<I...>) {
#if defined(__clang__)
  return __builtin_shufflevector(a, b, merge_index<UNIT, SPAN>(I, 0)...) +
         __builtin_shufflevector(a, b, merge_index<UNIT, SPAN>(I, 1)...);
#else
  return __builtin_shuffle(a, b, vi{merge_index<UNIT, SPAN>(I, 0)...}) +
         __builtin_shuffle(a, b, vi{merge_index<UNIT, SPAN>(I, 1)...});
#endif
}

// Horizontal sums of v[0..COUNT), COUNT <= LANES: lane i of the result is the sum of v[i]. Pairs are merged until one
// vector is left, first within the four lanes that shuffle cheaply, then across them.
template <int COUNT, int SUMMED = 1>
inline vf horizontal_sums(const vf *v) {
  if constexpr (SUMMED == LANES) {
    return v[0];
  } else {
    constexpr int UNIT = SUMMED < 4 ? 1 : 4, SPAN = SUMMED < 4 ? 4 : LANES, PAIRS = (COUNT + 1) / 2;
    vf next[PAIRS];
    for (int i = 0; i < PAIRS; ++i)
      next[i] = merge<UNIT, SPAN>(v[2 * i], 2 * i + 1 < COUNT ? v[2 * i + 1] : vf{}, std::make_index_sequence<LANES>{});
    return horizontal_sums<PAIRS, 2 * SUMMED>(next);
  }
}

// Adds the horizontal sums of v[0..COUNT) to out[0..COUNT).
template <int COUNT>
inline void add_sums(const vf *v, float *out) {
  constexpr int STEP = COUNT < LANES ? COUNT : LANES;
  for (int at = 0; at < COUNT; at += STEP) {
    vf part[STEP];
    for (int i = 0; i < STEP; ++i) part[i] = at + i < COUNT ? v[at + i] : vf{};
    const vf sums = horizontal_sums<STEP>(part);
    for (int i = 0; i < STEP && at + i < COUNT; ++i) out[at + i] += sums[i];
  }
}

template <int CG>
void backward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int c0,
                    int x0, int y0, const float *grad, float *partials) {
  const float top = y0 + 0.5f, middle = y0 + 0.5f * kTile;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    vf c[CG];
    broadcast(colours + int64_t(entries[i].gaussian) * channels + c0, c);
    float sum[kMoments + CG] = {};
    for (int bx = 0; bx < kTile; bx += LANES) {
      const float left = x0 + bx + 0.5f - s.x;
      if (beside(s, left)) continue;
      const vf dx = iota() + left;
      vf m[3] = {}, mc[CG] = {};
      for_each_row(s, dx, top, [&](int row, vf g) {
        const float *at = grad + bx + row * kTile;
        vf t{};
#pragma GCC unroll 4
        for (int k = 0; k < CG; ++k) {
          const vf up = load(at + k * kTilePixels);
          t = k ? t + up * c[k] : up * c[k];
          mc[k] += g * up;
        }
        const vf w = g * t;
        const float j = row - (kTile / 2 - 0.5f);  // centred, so that the shift to dy loses few bits
        m[0] += w;
        m[1] += w * j;
        m[2] += w * (j * j);
      });
      const float shift = middle - s.y;  // dy = j + shift
      const vf w = m[0], wy = m[1] + shift * m[0], wyy = m[2] + shift * (2.0f * m[1] + shift * m[0]);
      vf all[kMoments + CG] = {w, w * dx, w * dx * dx, wy, wy * dx, wyy};
      for (int k = 0; k < CG; ++k) all[kMoments + k] = mc[k];
      add_sums<kMoments + CG>(all, sum);
    }
    float *out = partials + int64_t(entries[i].slot) * (kMoments + channels);
    for (int j = 0; j < kMoments; ++j) out[j] = c0 == 0 ? sum[j] : out[j] + sum[j];
    for (int k = 0; k < CG; ++k) out[kMoments + c0 + k] = sum[kMoments + k];
  }
}

void forward(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
             float *tile) {
  for (int c = 0; c < channels;) {
    const int left = channels - c;
    float *out = tile + c * kTilePixels;
    const float *from = colours + c;
    switch (left) {
      case 1: forward_group<1>(entries, n, splats, from, channels, x0, y0, out); c += 1; break;
      case 2: forward_group<2>(entries, n, splats, from, channels, x0, y0, out); c += 2; break;
      case 3: forward_group<3>(entries, n, splats, from, channels, x0, y0, out); c += 3; break;
      default: forward_group<4>(entries, n, splats, from, channels, x0, y0, out); c += 4; break;
    }
  }
}

void backward(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
              const float *grad, float *partials) {
  for (int c = 0; c < channels;) {
    const int left = channels - c;
    const float *from = grad + c * kTilePixels;
    switch (left) {
      case 1: backward_group<1>(entries, n, splats, colours, channels, c, x0, y0, from, partials); c += 1; break;
      case 2: backward_group<2>(entries, n, splats, colours, channels, c, x0, y0, from, partials); c += 2; break;
      case 3: backward_group<3>(entries, n, splats, colours, channels, c, x0, y0, from, partials); c += 3; break;
      default: backward_group<4>(entries, n, splats, colours, channels, c, x0, y0, from, partials); c += 4; break;
    }
  }
}

float multiply_add(int64_t rounds) {
  vf chain[kPeakChains];
  for (int i = 0; i < kPeakChains; ++i) chain[i] = iota() + float(i);
  const vf factor = vf{} + 0.5f, term = vf{} + 1.0f;
  for (int64_t round = 0; round < rounds; ++round)
#pragma GCC unroll 16
    for (int i = 0; i < kPeakChains; ++i) chain[i] = chain[i] * factor + term;
  vf sum{};
  for (int i = 0; i < kPeakChains; ++i) sum += chain[i];
  return sum[0];
}

}  // namespace
}  // namespace sgi
