// The tile kernel of the rasteriser (forward, squared error, backward) in Google Highway: the algorithm of
// kernel_impl.hpp, line by line. foreach_target.h compiles this file once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernel_highway.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace sgi {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Arrays of vectors need a size known to the compiler: SVE and RISC-V vectors have none and are left out.
using D = hn::ScalableTag<float>;
using vf = hn::Vec<D>;
constexpr D d{};
constexpr int kLanes = hn::MaxLanes(d);

HWY_INLINE vf set(float x) { return hn::Set(d, x); }

// 2^x to about 1e-7 for x <= 126; 0 below -126.
HWY_INLINE vf exp2v(vf x) {
  const hn::RebindToSigned<D> di;
  const auto live = hn::Ge(x, set(-126.0f));
  x = hn::Min(x, set(126.0f));
  const vf magic = set(12582912.0f);  // 1.5 * 2^23: adding it rounds to an integer in the low bits
  const vf t = hn::Add(x, magic);
  const vf f = hn::Sub(x, hn::Sub(t, magic));
  vf p = hn::MulAdd(set(1.3333558e-3f), f, set(9.6181291e-3f));
  p = hn::MulAdd(p, f, set(5.5504109e-2f));
  p = hn::MulAdd(p, f, set(2.4022651e-1f));
  p = hn::MulAdd(p, f, set(6.9314718e-1f));
  p = hn::MulAdd(p, f, set(1.0f));
  const auto bits = hn::Add(hn::BitCast(di, p), hn::ShiftLeft<23>(hn::BitCast(di, t)));
  return hn::IfThenElseZero(live, hn::BitCast(d, bits));
}

// Rows [first, last) of a tile.
struct Rows {
  int first, last;
};

// The rows in which the Gaussian reaches the kLanes columns from dx on; `top` is the tile's first row of pixel centres.
HWY_INLINE Rows rows_of(const Splat &s, float dx, float top) {
  float up = -s.ry, down = s.ry;
  if (dx > -s.rx || dx + (kLanes - 1) < s.rx) {
    const float lo = HWY_MAX(dx, -s.rx), hi = HWY_MIN(dx + (kLanes - 1), s.rx);
    const auto end = [&](float at, float side) HWY_ATTR {
      const float u = at / s.rx;
      return s.lean * at + side * s.half_height * std::sqrt(HWY_MAX(0.0f, 1.0f - u * u));
    };
    down = end(HWY_MIN(HWY_MAX(s.low_dx, lo), hi), 1.0f);
    up = end(HWY_MIN(HWY_MAX(-s.low_dx, lo), hi), -1.0f);
  }
  const float from = s.y + up - top, to = s.y + down - top;
  return {from > 0 ? static_cast<int>(HWY_MIN(from, float(kTileHeight))) + 1 : 0,
          to < kTileHeight - 1 ? static_cast<int>(HWY_MAX(to, -1.0f)) + 1 : kTileHeight};
}

// Calls visit(column, dx) for the first column of every vector that a tile needs for the Gaussian; `left` is the tile's
// first column of pixel centres. Where that takes no more vectors, they are aligned.
template <class Visit>
HWY_INLINE void for_each_vector(const Splat &s, float left, Visit visit) {
  const float from = s.x - s.rx - left, to = s.x + s.rx - left;
  int first = from > 0 ? static_cast<int>(HWY_MIN(from, float(kTileWidth))) : 0;
  const int last = to < kTileWidth - 1 ? static_cast<int>(HWY_MAX(to, -1.0f)) : kTileWidth - 1;
  const int aligned = first & -kLanes;
  if ((last - aligned) / kLanes == (last - first) / kLanes) first = aligned;
  for (; first <= last; first += kLanes) visit(first, left + first - s.x);
}

// Calls visit(row, dy, G) for every row; `dx` is where the lanes lie from the Gaussian's centre.
template <class Visit>
HWY_INLINE void for_each_row(const Splat &s, vf dx, float top, Rows rows, Visit visit) {
  const vf quad = hn::Mul(hn::Mul(set(s.a), dx), dx);
  const vf slope = hn::Mul(set(s.b), dx);
  const vf kk = set(s.k);
  for (int row = rows.first; row < rows.last;) {
    float dy = top + row - s.y;
    vf g = exp2v(hn::MulAdd(hn::Add(slope, set(s.c * dy)), set(dy), quad));
    vf r = exp2v(hn::Add(slope, set(s.c * (2.0f * dy + 1.0f))));
    const int stop = HWY_MIN(row + s.span, rows.last);
    for (; row < stop; ++row) {
      visit(row, dy, g);
      g = hn::Mul(g, r);
      r = hn::Mul(r, kk);
      dy += 1.0f;
    }
  }
}

template <int CG>
void forward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                   int y0, float *tile) {
  const float left = x0 + 0.5f, top = y0 + 0.5f;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    vf c[CG];
    for (int k = 0; k < CG; ++k) c[k] = set(colours[int64_t(entries[i].gaussian) * channels + k]);
    for_each_vector(s, left, [&](int column, float dx) HWY_ATTR {
      for_each_row(s, hn::Iota(d, dx), top, rows_of(s, dx, top), [&](int row, float, vf g) HWY_ATTR {
        float *at = tile + row * kTileStride + column;
        HWY_UNROLL(4)
        for (int k = 0; k < CG; ++k, at += kTilePlane) hn::StoreU(hn::MulAdd(g, c[k], hn::LoadU(d, at)), d, at);
      });
    });
  }
}

// Adds the halves of v until four lanes are left.
template <class DV, class V>
HWY_INLINE auto fold(DV, V v) {
  if constexpr (hn::MaxLanes(DV()) <= 4) {
    return v;
  } else {
    const hn::Half<DV> half;
    return fold(half, hn::Add(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}

// Horizontal sums of v[0..4), one per lane of the result's four.
HWY_INLINE auto sums_of_four(const vf *v) {
  const hn::RepartitionToWide<D> dw;
  const vf a = hn::Add(hn::InterleaveLower(d, v[0], v[1]), hn::InterleaveUpper(d, v[0], v[1]));
  const vf b = hn::Add(hn::InterleaveLower(d, v[2], v[3]), hn::InterleaveUpper(d, v[2], v[3]));
  const auto aw = hn::BitCast(dw, a), bw = hn::BitCast(dw, b);
  return fold(d, hn::Add(hn::BitCast(d, hn::InterleaveLower(dw, aw, bw)),
                         hn::BitCast(d, hn::InterleaveUpper(dw, aw, bw))));
}

template <int CG>
void backward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int c0,
                    int x0, int y0, const float *grad, float *partials) {
  constexpr int kSums = (kMoments + CG + 3) / 4 * 4;
  const float left = x0 + 0.5f, top = y0 + 0.5f;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    vf c[CG], all[kSums];
    for (int k = 0; k < CG; ++k) c[k] = set(colours[int64_t(entries[i].gaussian) * channels + c0 + k]);
    for (vf &sum : all) sum = hn::Zero(d);
    for_each_vector(s, left, [&](int column, float first_dx) HWY_ATTR {
      const vf dx = hn::Iota(d, first_dx);
      vf w = hn::Zero(d), wy = w, wyy = w;
      for_each_row(s, dx, top, rows_of(s, first_dx, top), [&](int row, float dy, vf g) HWY_ATTR {
        const float *at = grad + row * kTileStride + column;
        vf t = hn::Zero(d);
        HWY_UNROLL(4)
        for (int k = 0; k < CG; ++k) {
          const vf up = hn::LoadU(d, at + k * kTilePlane);
          t = k ? hn::MulAdd(up, c[k], t) : hn::Mul(up, c[k]);
          all[kMoments + k] = hn::MulAdd(g, up, all[kMoments + k]);
        }
        const vf m = hn::Mul(g, t);
        w = hn::Add(w, m);
        wy = hn::MulAdd(m, set(dy), wy);
        wyy = hn::MulAdd(m, set(dy * dy), wyy);
      });
      const vf wx = hn::Mul(w, dx);
      all[0] = hn::Add(all[0], w);
      all[1] = hn::Add(all[1], wx);
      all[2] = hn::MulAdd(wx, dx, all[2]);
      all[3] = hn::Add(all[3], wy);
      all[4] = hn::MulAdd(wy, dx, all[4]);
      all[5] = hn::Add(all[5], wyy);
    });
    float sum[kSums];
    for (int j = 0; j < kSums; j += 4) hn::StoreU(sums_of_four(all + j), hn::CappedTag<float, 4>(), sum + j);
    float *out = partials + int64_t(entries[i].slot) * (kMoments + channels);
    for (int j = 0; j < kMoments; ++j) out[j] = c0 == 0 ? sum[j] : out[j] + sum[j];
    for (int k = 0; k < CG; ++k) out[kMoments + c0 + k] = sum[kMoments + k];
  }
}

void forward(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
             float *tile) {
  constexpr decltype(&forward_group<1>) kGroup[] = {forward_group<1>, forward_group<2>, forward_group<3>,
                                                    forward_group<4>};
  for (int c = 0; c < channels; c += 4)
    kGroup[HWY_MIN(channels - c, 4) - 1](entries, n, splats, colours + c, channels, x0, y0, tile + c * kTilePlane);
}

void backward(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
              const float *grad, float *partials) {
  constexpr decltype(&backward_group<1>) kGroup[] = {backward_group<1>, backward_group<2>, backward_group<3>,
                                                     backward_group<4>};
  for (int c = 0; c < channels; c += 4)
    kGroup[HWY_MIN(channels - c, 4) - 1](entries, n, splats, colours, channels, c, x0, y0,
                                         grad + c * kTilePlane, partials);
}

double compare(float *tile, int channels, const TileRect &r, const float *target, int64_t width, int64_t height,
               float weight) {
  double total = 0;
  for (int c = 0; c < channels; ++c) {
    vf sum = hn::Zero(d);
    for (int y = 0; y < kTileHeight; ++y) {
      float *row = tile + c * kTilePlane + y * kTileStride;
      const bool inside = y >= r.row0 && y < r.row1;
      std::fill(row, row + (inside ? r.col0 : kTileStride), 0.0f);
      if (!inside) continue;
      std::fill(row + r.col1, row + kTileStride, 0.0f);
      const float *wanted = target + (c * height + r.y + y) * width + r.x;
      int x = r.col0;
      for (; x + kLanes <= r.col1; x += kLanes) {
        const vf error = hn::Sub(hn::LoadU(d, row + x), hn::LoadU(d, wanted + x));
        sum = hn::MulAdd(error, error, sum);
        hn::StoreU(hn::Mul(set(2.0f * weight), error), d, row + x);
      }
      float rest = 0;
      for (; x < r.col1; ++x) {
        const float error = row[x] - wanted[x];
        rest += error * error;
        row[x] = 2.0f * weight * error;
      }
      total += rest;
    }
    total += hn::GetLane(hn::SumOfLanes(d, sum));
  }
  return total;
}

TileKernel kernel() { return {forward, compare, backward, nullptr, hwy::TargetName(HWY_TARGET), kLanes}; }

}  // namespace HWY_NAMESPACE
}  // namespace sgi
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sgi {
HWY_EXPORT(kernel);

// The kernels of every instruction set that was compiled and that this processor has, the best first.
std::vector<TileKernel> highway_kernels() {
#ifdef HWY_COMPILE_ONLY_STATIC
  return {HWY_STATIC_DISPATCH(kernel)()};
#else
  std::vector<TileKernel> found;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    found.push_back(HWY_DYNAMIC_DISPATCH(kernel)());
  }
  return found;
#endif
}
}  // namespace sgi
#endif
