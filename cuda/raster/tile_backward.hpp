// From dL/dI in a tile to moments of its Gaussians.
#pragma once
#include "cuda/raster/tile_memory.hpp"

namespace sgi {
namespace {

// Moments of the pixels of one row in every kRowLanes of a staged Gaussian: kPairMoments, then G dL/dI per channel.
template <int C>
inline void walk_rows(const TileView &v, const TileMemory<C> &memory, const StagedSplat<C> &g, int lane, float least,
                      float *sum) {
  const TileSplat &s = g.s;
  const auto bounded = [](float at, int first, int last) {
    return at <= float(first) ? first : at >= float(last + 1) ? last + 1 : int(at);
  };
  const int first = bounded(s.y - s.ellipse.ry - v.top + 1.0f, v.first_row, v.last_row);
  const int last = bounded(s.y + s.ellipse.ry - v.top + 1.0f, v.first_row, v.last_row);
  for (int row = first + lane; row < last; row += kRowLanes) {
    const float dy = v.top + float(row) - s.y;
    float left, right;
    s.ellipse.extent(dy, dy, left, right);
    const int from = bounded(s.x + left - v.left + 1.0f, v.first_column, v.last_column);
    const int to = bounded(s.x + right - v.left + 1.0f, v.first_column, v.last_column);
    float w = 0.0f, wx = 0.0f, wxx = 0.0f;
    for (int column = from; column < to; ++column) {
      const float dx = v.left + float(column) - s.x, t = dy - s.lean * dx;
      const float height = exp2v(s.across * dx * dx + s.down * t * t);
      if (!(height >= least)) continue;
      float along = 0.0f;
      for (int c = 0; c < C; ++c) {
        const float slope = memory.slope[c][row][column];
        along += slope * g.colour[c];
        sum[kPairMoments + c] += height * slope;
      }
      const float m = height * along;
      w += m;
      wx += m * dx;
      wxx += m * dx * dx;
    }
    sum[0] += wx;
    sum[1] += wxx;
    sum[2] += w * dy;
    sum[3] += wx * dy;
    sum[4] += w * dy * dy;
  }
}

// From dL/dI in shared memory to partials [slot, kPairMoments + C] of every pair of the tile.
template <int C, int THREADS>
inline void differentiate_tile(const ThreadBlock<THREADS> &block, const RasterArguments &a, const TileView &v,
                               TileMemory<C> &memory) {
  constexpr int kSums = kPairMoments + C;
  const int begin = a.tile_start[v.tile], end = a.tile_start[v.tile + 1];
  const float least = least_height(a.cutoff);
  PerThread<float, THREADS> sum[kSums];
  for (int at = begin; at < end; at += kStaged) {
    const int staged = end - at < kStaged ? end - at : kStaged;
    block.each([&](int t) {
      if (t < staged) stage<C>(a, at + t, memory.splat[t]);
    });
    for (int some = 0; some < staged; some += THREADS / kRowLanes) {
      block.each_of_warp([&](int t) {
        float own[kSums] = {};
        const int i = some + t / kRowLanes;
        if (i < staged) walk_rows<C>(v, memory, memory.splat[i], t % kRowLanes, least, own);
        for (int k = 0; k < kSums; ++k) sum[k][t] = own[k];
      });
#pragma unroll
      for (int k = 0; k < kSums; ++k) block.template group_sum<kRowLanes>(sum[k]);
      block.each_of_warp([&](int t) {
        const int i = some + t / kRowLanes;
        if (t % kRowLanes || i >= staged) return;
        float *out = a.partials + int64_t(memory.splat[i].slot) * kSums;
        for (int k = 0; k < kSums; ++k) out[k] = sum[k][t];
      });
    }
    block.each([](int) {});
  }
}

}  // namespace
}  // namespace sgi
