// A block draws a tile, compares it with the target and differentiates it; the image is never stored.
//
// Forward, a warp has sub-tiles of 8×4 pixels: its lanes first ask which of 32 Gaussians reach the sub-tile, then each
// adds those to its own pixel, in the tile's order. Backward, four lanes have a pair: each walks every fourth row of
// the ellipse over dL/dI in shared memory, and their moments are added in a fixed order. Both leave out what lies
// beyond the cutoff by the same test.
#pragma once
#include "cuda/raster/tiling.hpp"

namespace sgi {

constexpr int kTileThreads = 128, kStaged = kTileThreads;  // Gaussians of a tile in shared memory at a time
constexpr int kSubWidth = 8, kSubHeight = 4, kSubTiles = kTileColumns * kTileRows / kWarp / (kTileThreads / kWarp);
constexpr int kTilePitch = kTileColumns + 1, kRowLanes = 4;
constexpr int kPairMoments = 5;  // of w: x, x², y, xy, y²

namespace {

template <int C>
struct StagedSplat {
  TileSplat s;
  float colour[C];
  uint32_t slot;
};

template <int C>
struct TileMemory {
  StagedSplat<C> splat[kStaged];
  float slope[C][kTileRows][kTilePitch];  // dL/dI
  double error[2][kTileThreads];
};

// A tile in pixels of the view; columns and rows of it from `first` to `last` are visible.
struct TileView {
  int tile, x, y;
  float left, top;  // centre of the first pixel, in the plane
  int first_column, last_column, first_row, last_row;
};

inline TileView tile_view(const RasterArguments &a, int tile) {
  const CudaView view = view_of(a);
  const int across = view.tiles_x();
  const int x = (view.tile_x0() + tile % across) * kTileColumns - a.x0;
  const int y = (view.tile_y0() + tile / across) * kTileRows - a.y0;
  const auto most = [](int v, int limit) { return v < limit ? v : limit; };
  return {tile,
          x,
          y,
          float(x + a.x0) + 0.5f,
          float(y + a.y0) + 0.5f,
          x < 0 ? -x : 0,
          most(a.width - x, kTileColumns) - 1,
          y < 0 ? -y : 0,
          most(a.height - y, kTileRows) - 1};
}

// Column and row of sub-tile q of a thread, and of its pixel.
struct Place {
  int column, row;
};
inline Place corner_of(int t, int q) {
  const int number = t / kWarp * kSubTiles + q, across = kTileColumns / kSubWidth;
  return {number % across * kSubWidth, number / across * kSubHeight};
}
inline Place pixel_of(int t, int q) {
  const Place corner = corner_of(t, q);
  const int lane = t % kWarp;
  return {corner.column + lane % kSubWidth, corner.row + lane / kSubWidth};
}

inline bool is_visible(const TileView &v, Place p) {
  return p.column >= v.first_column && p.column <= v.last_column && p.row >= v.first_row && p.row <= v.last_row;
}

inline float exponent_at(const TileSplat &s, float dx, float dy) { return (s.a * dx + s.b * dy) * dx + s.c * dy * dy; }

template <int C>
inline void stage(const RasterArguments &a, int entry, StagedSplat<C> &to) {
  const int i = a.owner[a.slots[entry]];
  to.s = static_cast<const TileSplat *>(a.splats)[i];
  to.slot = a.slots[entry];
  for (int c = 0; c < C; ++c) to.colour[c] = a.colours[int64_t(i) * C + c];
}

// Whether the ellipse reaches the sub-tile at `corner`.
inline bool reaches(const TileSplat &s, const TileView &v, Place corner) {
  const float lo = v.top + float(corner.row) - s.y, hi = lo + float(kSubHeight - 1);
  if (lo > s.ellipse.ry || hi < -s.ellipse.ry) return false;
  float left, right;
  s.ellipse.extent(lo, hi, left, right);
  const float from = v.left + float(corner.column) - s.x, margin = 0.01f;
  return from <= right + margin && from + float(kSubWidth - 1) >= left - margin;
}

template <int C>
struct Pixels {
  float value[kSubTiles][C];
};

// Adds the Gaussians of a tile to the pixels of every thread.
template <int C, int THREADS>
inline void draw_tile(const ThreadBlock<THREADS> &block, const RasterArguments &a, const TileView &v,
                      TileMemory<C> &memory, PerThread<Pixels<C>, THREADS> &pixels) {
  const int begin = a.tile_start[v.tile], end = a.tile_start[v.tile + 1];
  const float least = least_exponent(a.cutoff);
  PerThread<bool, THREADS> hit;
  PerThread<uint32_t, THREADS> mask;
  block.each([&](int t) {
    for (int q = 0; q < kSubTiles; ++q)
      for (int c = 0; c < C; ++c) pixels[t].value[q][c] = 0.0f;
  });
  for (int at = begin; at < end; at += kStaged) {
    const int staged = end - at < kStaged ? end - at : kStaged;
    block.each([&](int t) {
      if (t < staged) stage<C>(a, at + t, memory.splat[t]);
    });
#pragma unroll
    for (int q = 0; q < kSubTiles; ++q)
      for (int some = 0; some < staged; some += kWarp) {
        block.each_of_warp([&](int t) {
          const int i = some + t % kWarp;
          hit[t] = i < staged && reaches(memory.splat[i].s, v, corner_of(t, q));
        });
        block.ballot(hit, mask);
        block.each_of_warp([&](int t) {
          const Place p = pixel_of(t, q);
          const float x = v.left + float(p.column), y = v.top + float(p.row);
          for (uint32_t left = mask[t]; left; left &= left - 1) {
            const StagedSplat<C> &g = memory.splat[some + lowest_bit(left)];
            const float power = exponent_at(g.s, x - g.s.x, y - g.s.y);
            const float height = power >= least ? exp2v(power) : 0.0f;
            for (int c = 0; c < C; ++c) pixels[t].value[q][c] += height * g.colour[c];
          }
        });
      }
    block.each([](int) {});
  }
}

inline int64_t sample_at(const RasterArguments &a, const TileView &v, Place p, int channel) {
  return (int64_t(channel) * a.height + v.y + p.row) * a.width + v.x + p.column;
}

// Turns drawn pixels into dL/dI in shared memory, and leaves the tile's squared error without and with weights.
template <int C, int THREADS>
inline void compare_tile(const ThreadBlock<THREADS> &block, const RasterArguments &a, const TileView &v,
                         TileMemory<C> &memory, PerThread<Pixels<C>, THREADS> &pixels) {
  block.each([&](int t) {
    double sum = 0, weighted = 0;
    for (int q = 0; q < kSubTiles; ++q) {
      const Place p = pixel_of(t, q);
      const bool visible = is_visible(v, p);
      const float weight = a.weights && visible ? a.weights[int64_t(v.y + p.row) * a.width + v.x + p.column] : a.weight;
      for (int c = 0; c < C; ++c) {
        const float error = visible ? pixels[t].value[q][c] - a.target[sample_at(a, v, p, c)] : 0.0f;
        memory.slope[c][p.row][p.column] = 2.0f * weight * error;
        sum += error * error;
        weighted += weight * error * error;
      }
    }
    memory.error[0][t] = sum;
    memory.error[1][t] = weighted;
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

// Moments of the pixels of one row in every kRowLanes of a staged Gaussian: kPairMoments, then G dL/dI per channel.
template <int C>
inline void walk_rows(const TileView &v, const TileMemory<C> &memory, const StagedSplat<C> &g, int lane, float least,
                      float *sum) {
  const TileSplat &s = g.s;
  const float margin = 0.01f;
  const auto bounded = [](float at, int first, int last) {
    return at <= float(first) ? first : at >= float(last + 1) ? last + 1 : int(at);
  };
  const int first = bounded(s.y - s.ellipse.ry - margin - v.top + 1.0f, v.first_row, v.last_row);
  const int last = bounded(s.y + s.ellipse.ry + margin - v.top + 1.0f, v.first_row, v.last_row);
  for (int row = first + lane; row < last; row += kRowLanes) {
    const float dy = v.top + float(row) - s.y;
    float left, right;
    s.ellipse.extent(dy, dy, left, right);
    const int from = bounded(s.x + left - margin - v.left + 1.0f, v.first_column, v.last_column);
    const int to = bounded(s.x + right + margin - v.left + 1.0f, v.first_column, v.last_column);
    float w = 0.0f, wx = 0.0f, wxx = 0.0f;
    for (int column = from; column < to; ++column) {
      const float dx = v.left + float(column) - s.x, power = exponent_at(s, dx, dy);
      if (!(power >= least)) continue;
      const float height = exp2v(power);
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
  const float least = least_exponent(a.cutoff);
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

template <int C>
inline void forward_tile(const ThreadBlock<kTileThreads> &block, const RasterArguments &a, TileMemory<C> &memory) {
  const TileView v = tile_view(a, block.index());
  PerThread<Pixels<C>, kTileThreads> pixels;
  draw_tile<C>(block, a, v, memory, pixels);
  block.each([&](int t) {
    for (int q = 0; q < kSubTiles; ++q) {
      const Place p = pixel_of(t, q);
      if (!is_visible(v, p)) continue;
      for (int c = 0; c < C; ++c) a.image[sample_at(a, v, p, c)] = pixels[t].value[q][c];
    }
  });
}

template <int C>
inline void squared_error_tile(const ThreadBlock<kTileThreads> &block, const RasterArguments &a,
                               TileMemory<C> &memory) {
  const TileView v = tile_view(a, block.index());
  PerThread<Pixels<C>, kTileThreads> pixels;
  draw_tile<C>(block, a, v, memory, pixels);
  compare_tile<C>(block, a, v, memory, pixels);
  differentiate_tile<C>(block, a, v, memory);
}

template <int C>
inline void backward_tile(const ThreadBlock<kTileThreads> &block, const RasterArguments &a, TileMemory<C> &memory) {
  const TileView v = tile_view(a, block.index());
  block.each([&](int t) {
    for (int q = 0; q < kSubTiles; ++q) {
      const Place p = pixel_of(t, q);
      for (int c = 0; c < C; ++c)
        memory.slope[c][p.row][p.column] = is_visible(v, p) ? a.slopes[sample_at(a, v, p, c)] : 0.0f;
    }
  });
  differentiate_tile<C>(block, a, v, memory);
}

}  // namespace

#define SGI_TILE_KERNELS(C)                                      \
  SGI_KERNEL(forward_##C, kTileThreads, RasterArguments) {       \
    SGI_SHARED(TileMemory<C>, memory);                           \
    forward_tile<C>(block, a, memory);                           \
  }                                                              \
  SGI_KERNEL(squared_error_##C, kTileThreads, RasterArguments) { \
    SGI_SHARED(TileMemory<C>, memory);                           \
    squared_error_tile<C>(block, a, memory);                     \
  }                                                              \
  SGI_KERNEL(backward_##C, kTileThreads, RasterArguments) {      \
    SGI_SHARED(TileMemory<C>, memory);                           \
    backward_tile<C>(block, a, memory);                          \
  }
SGI_TILE_KERNELS(1)
SGI_TILE_KERNELS(2)
SGI_TILE_KERNELS(3)
SGI_TILE_KERNELS(4)
#undef SGI_TILE_KERNELS

}  // namespace sgi
