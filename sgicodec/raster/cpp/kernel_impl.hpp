// The tile kernel, written once over vectors of LANES floats (compiler vector extensions) and included by one
// translation unit per instruction set, each in its own unnamed namespace.
//
// Along a column, G obeys a second-order recurrence: G(y+1) = G(y) r(y), r(y+1) = r(y) k with k = 2^(2c) constant.
// Two exponentials per lane start a column, then two products per row replace the exponential of every pixel.
// `Splat::span` bounds the rows between fresh starts so that a start value never underflows where it later matters.
#include <cstring>
#include <utility>

#include "kernel.hpp"

namespace sgi {
namespace {

using vf = float __attribute__((vector_size(LANES * 4)));
using vi = int32_t __attribute__((vector_size(LANES * 4)));

inline vf load(const float *p) {
  vf v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store(float *p, vf v) { std::memcpy(p, &v, sizeof v); }

inline vf iota() {
  vf v;
  for (int i = 0; i < LANES; ++i) v[i] = static_cast<float>(i);
  return v;
}

// 2^x to about 1e-7 for x <= 126; 0 below -126.
inline vf exp2v(vf x) {
  const vf lo = vf{} - 126.0f, hi = vf{} + 126.0f;
  const vi live = x >= lo;
  x = x > hi ? hi : x;
  const vf magic = vf{} + 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer in the low bits
  const vf t = x + magic;
  const vf f = x - (t - magic);
  vf p = vf{} + 1.3333558e-3f;
  p = p * f + 9.6181291e-3f;
  p = p * f + 5.5504109e-2f;
  p = p * f + 2.4022651e-1f;
  p = p * f + 6.9314718e-1f;
  p = p * f + 1.0f;
  const vi bits = (vi)p + ((vi)t << 23);
  return (vf)(bits & live);
}

// Accumulator rows that fit the register file beside the working set.
template <int CG>
constexpr int block_rows() {
  if (LANES == 16) return CG == 1 ? 16 : CG <= 3 ? 8 : 4;
  return CG == 1 ? 8 : CG <= 3 ? 4 : 2;
}

template <int CG, int ROWS, int SPAN>
inline __attribute__((always_inline)) void add_splat(const Splat &s, const float *colour, vf dx, float dy0,
                                                     vf (&acc)[CG][ROWS]) {
  vf c[CG];
  for (int k = 0; k < CG; ++k) c[k] = vf{} + colour[k];
  const vf quad = s.a * dx * dx;
  const vf slope = s.b * dx;
  const vf kk = vf{} + s.k;
  vf g{}, r{};
#pragma GCC unroll 16
  for (int row = 0; row < ROWS; ++row) {
    if (row % SPAN == 0) {
      const float dy = dy0 + row;
      g = exp2v(quad + (slope + s.c * dy) * dy);
      if (SPAN > 1) r = exp2v(slope + s.c * (2.0f * dy + 1.0f));
    }
#pragma GCC unroll 4
    for (int k = 0; k < CG; ++k) acc[k][row] += g * c[k];
    if (row % SPAN != SPAN - 1) {
      g *= r;
      r *= kk;
    }
  }
}

// Narrow blocks often lie beside a Gaussian. With eight lanes the forward pass loses more by the test than it saves.
constexpr bool kSkipColumns = LANES < 8;

template <int CG>
void forward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                   int y0, float *tile) {
  constexpr int ROWS = block_rows<CG>();
  constexpr int LONG = ROWS < 8 ? ROWS : 8;
  constexpr int MID = ROWS < 4 ? ROWS : 4;
  for (int bx = 0; bx < kTile; bx += LANES) {
    const vf px = iota() + (x0 + bx + 0.5f);
    for (int by = 0; by < kTile; by += ROWS) {
      const float left = x0 + bx + 0.5f, top = y0 + by + 0.5f;
      vf acc[CG][ROWS] = {};
      for (int64_t i = 0; i < n; ++i) {
        const Splat &s = splats[entries[i].gaussian];
        const float dx0 = left - s.x, dy0 = top - s.y;
        if (dy0 > s.ry || dy0 + (ROWS - 1) < -s.ry) continue;
        if (kSkipColumns && (dx0 > s.rx || dx0 + (LANES - 1) < -s.rx)) continue;
        const float *colour = colours + int64_t(entries[i].gaussian) * channels;
        const vf dx = px - s.x;
        if (s.span >= LONG) {
          add_splat<CG, ROWS, LONG>(s, colour, dx, dy0, acc);
        } else if (s.span >= MID) {
          add_splat<CG, ROWS, MID>(s, colour, dx, dy0, acc);
        } else {
          add_splat<CG, ROWS, 1>(s, colour, dx, dy0, acc);
        }
      }
      for (int k = 0; k < CG; ++k)
        for (int row = 0; row < ROWS; ++row) {
          float *p = tile + k * kTilePixels + (by + row) * kTile + bx;
          store(p, load(p) + acc[k][row]);
        }
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
inline __attribute__((always_inline)) void gather_rows(const Splat &s, const float *colour, vf dx, float top, int first,
                                                       int last, const float *grad, vf (&m)[3], vf (&mc)[CG]) {
  vf c[CG];
  for (int k = 0; k < CG; ++k) c[k] = vf{} + colour[k];
  const vf quad = s.a * dx * dx;
  const vf slope = s.b * dx;
  const vf kk = vf{} + s.k;
  vf j = vf{} + (first - (kTile / 2 - 0.5f));  // rows, centred so that the shift to dy loses few bits
  for (int row = first; row < last;) {
    const float dy = top + row - s.y;
    vf g = exp2v(quad + (slope + s.c * dy) * dy);
    vf r = exp2v(slope + s.c * (2.0f * dy + 1.0f));
    const int stop = row + s.span < last ? row + s.span : last;
    for (; row < stop; ++row) {
      const float *at = grad + row * kTile;
      vf t{};
#pragma GCC unroll 4
      for (int k = 0; k < CG; ++k) {
        const vf up = load(at + k * kTilePixels);
        t = k ? t + up * c[k] : up * c[k];
        mc[k] += g * up;
      }
      const vf w = g * t, wj = w * j;
      m[0] += w;
      m[1] += wj;
      m[2] += wj * j;
      j += 1.0f;
      g *= r;
      r *= kk;
    }
  }
}

template <int CG>
void backward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int c0,
                    int x0, int y0, const float *grad, float *partials) {
  const float top = y0 + 0.5f, middle = y0 + 0.5f * kTile;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    const float *colour = colours + int64_t(entries[i].gaussian) * channels + c0;
    const float from = s.y - s.ry - top, to = s.y + s.ry - top;
    const int first = from > 0 ? static_cast<int>(from) : 0;
    const int last = to < kTile - 1 ? static_cast<int>(to) + 1 : kTile;
    float sum[kMoments + CG] = {};
    for (int bx = 0; bx < kTile; bx += LANES) {
      const float dx0 = x0 + bx + 0.5f - s.x;
      if (LANES < kTile && (dx0 > s.rx || dx0 + (LANES - 1) < -s.rx)) continue;
      const vf dx = iota() + dx0;
      vf m[3] = {}, mc[CG] = {};
      gather_rows<CG>(s, colour, dx, top, first, last, grad + bx, m, mc);
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
