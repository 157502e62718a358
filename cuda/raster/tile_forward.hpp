// Gaussians onto the pixels of a tile, and the pixels compared with the target.
#pragma once
#include "cuda/raster/tile_memory.hpp"

namespace sgi {
namespace {

// Whether the ellipse reaches the columns of a warp, of which `column` is the first.
inline bool reaches(const TileSplat &s, const TileView &v, int column) {
  const float lo = v.top - s.y, hi = lo + float(kTileRows - 1);
  if (lo > s.ellipse.ry || hi < -s.ellipse.ry) return false;
  float left, right;
  s.ellipse.extent(lo, hi, left, right);
  const float from = v.left + float(column) - s.x;
  return from <= right && from + float(kSubWidth - 1) >= left;
}

template <int C>
struct Pixels {
  float value[kThreadRows][C];
};

// Adds a Gaussian to the pixels of a thread, of which the first is `at` in the plane.
template <int C>
inline void add_heights(const StagedSplat<C> &g, Place at, float least, Pixels<C> &pixels) {
  Heights<float> heights(g.s, (float(at.column) + 0.5f) - g.s.x);
  const int behind = at.row - g.s.first;  // rows behind the first one of the Gaussian
  int skipped = behind < 0 ? -behind : 0, into = behind < 0 ? 0 : g.s.into_run(at.row);
  if (skipped < kThreadRows) heights.start(g.s, at.row + skipped, into);
#pragma unroll
  for (int q = 0; q < kThreadRows; ++q) {
    if (q < skipped) continue;
    if (into == g.s.span) {
      heights.start(g.s, at.row + q);
      into = 0;
    }
    const float height = heights.g >= least ? heights.g : 0.0f;
    for (int c = 0; c < C; ++c) pixels.value[q][c] += height * g.colour[c];
    heights.next(g.s);
    ++into;
  }
}

// Adds the Gaussians of a tile to the pixels of every thread.
template <int C, int THREADS>
inline void draw_tile(const ThreadBlock<THREADS> &block, const RasterArguments &a, const TileView &v,
                      TileMemory<C> &memory, PerThread<Pixels<C>, THREADS> &pixels) {
  const int begin = a.tile_start[v.tile], end = a.tile_start[v.tile + 1];
  const float least = least_height(a.cutoff);
  PerThread<bool, THREADS> hit;
  PerThread<uint32_t, THREADS> mask;
  block.each([&](int t) {
    for (int q = 0; q < kThreadRows; ++q)
      for (int c = 0; c < C; ++c) pixels[t].value[q][c] = 0.0f;
  });
  for (int at = begin; at < end; at += kStaged) {
    const int staged = end - at < kStaged ? end - at : kStaged;
    block.each([&](int t) {
      if (t < staged) stage<C>(a, at + t, memory.splat[t]);
    });
    for (int some = 0; some < staged; some += kWarp) {
      block.each_of_warp([&](int t) {
        const int i = some + t % kWarp;
        hit[t] = i < staged && reaches(memory.splat[i].s, v, t / kWarp * kSubWidth);
      });
      block.ballot(hit, mask);
      block.each_of_warp([&](int t) {
        const Place first = first_of(t), at{v.x + a.x0 + first.column, v.y + a.y0 + first.row};
        for (uint32_t left = mask[t]; left; left &= left - 1)
          add_heights<C>(memory.splat[some + lowest_bit(left)], at, least, pixels[t]);
      });
    }
    block.each([](int) {});
  }
}

inline int64_t sample_at(const RasterArguments &a, const TileView &v, Place p, int channel) {
  return (int64_t(channel) * a.height + v.y + p.row) * a.width + v.x + p.column;
}

// Turns rendered pixels into dL/dI in shared memory, and leaves the tile's squared error without weights, and its loss.
template <int C, bool ABSOLUTE, int THREADS>
inline void compare_tile(const ThreadBlock<THREADS> &block, const RasterArguments &a, const TileView &v,
                         TileMemory<C> &memory, PerThread<Pixels<C>, THREADS> &pixels) {
  block.each([&](int t) {
    float sum = 0, loss = 0;  // of 32 errors at most
    for (int q = 0; q < kThreadRows; ++q) {
      const Place p = pixel_of(t, q);
      const bool visible = is_visible(v, p);
      float weight = a.weight;
      if (a.weights && visible) weight *= a.weights[int64_t(v.y + p.row) * a.width + v.x + p.column];
      for (int c = 0; c < C; ++c) {
        const float error = visible ? pixels[t].value[q][c] - a.target[sample_at(a, v, p, c)] : 0.0f;
        const float slope = weight * (ABSOLUTE ? signv(error) : 2.0f * error);
        memory.slope[c][p.row][p.column] = slope;
        sum += error * error;
        loss += slope * error;
      }
    }
    memory.error[0][t] = sum;
    memory.error[1][t] = ABSOLUTE ? loss : 0.5f * loss;
  });
  block.each([&](int t) {  // in two stages: a chain of all threads would be long
    if (t >= 2 * kWarp) return;
    double sum = 0;
    for (int i = t % kWarp; i < THREADS; i += kWarp) sum += memory.error[t / kWarp][i];
    memory.error[t / kWarp][t % kWarp] = sum;
  });
  block.each([&](int t) {
    if (t >= 2) return;
    double sum = 0;
    for (int i = 0; i < kWarp; ++i) sum += memory.error[t][i];
    a.errors[2 * v.tile + t] = sum;
  });
}

}  // namespace
}  // namespace sgi
