// Drawing a tile, in vectors of LANES floats.
#pragma once
#include "raster/tile_walk.hpp"

namespace sgi {
namespace {

template <Runs RUNS, int CG>
void draw_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0,
                int y0, float least, float *tile) {
  const float left = x0 + 0.5f, top = y0 + 0.5f;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    vf c[CG];
    broadcast(colours + int64_t(entries[i].gaussian) * channels, c);
    for_each_vector(s, left, [&](int column, float dx) {
      for_each_row<RUNS>(s, columns_from(s, x0 + column), y0, rows_of(s, dx, top), [&](int row, float, vf g) {
        float *at = tile + row * kTileStride + column;
        g = select(g >= least, g, vf{});
#pragma GCC unroll 4
        for (int k = 0; k < CG; ++k) store(at + k * kTilePlane, load(at + k * kTilePlane) + g * c[k]);
      });
    });
  }
}

// As `TileKernel::forward`.
template <Runs RUNS>
void draw_tile(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
               float least, float *tile) {
  for_each_group(channels, [&](int c, auto group) {
    draw_group<RUNS, decltype(group)::value>(entries, n, splats, colours + c, channels, x0, y0, least,
                                             tile + c * kTilePlane);
  });
}

}  // namespace
}  // namespace sgi
