// A block draws a tile, compares it with the target and differentiates it; the image is never stored.
//
// Forward, a warp has sub-tiles of 8×4 pixels: its lanes first ask which of 32 Gaussians reach the sub-tile, then each
// adds those to its own pixel, in the tile's order. Backward, four lanes have a pair: each walks every fourth row of
// the ellipse over dL/dI in shared memory, and their moments are added in a fixed order. Both leave out what lies
// beyond the cutoff by the same test.
#pragma once
#include "cuda/raster/tile_backward.hpp"
#include "cuda/raster/tile_forward.hpp"

namespace sgi {
namespace {

template <int C>
inline void forward_tile(const ThreadBlock<kTileThreads> &block, const RasterArguments &a, TileMemory<C> &memory) {
  const TileView v = tile_view(a, block.index());
  PerThread<Pixels<C>, kTileThreads> pixels;
  draw_tile<C>(block, a, v, memory, pixels);
  block.each([&](int t) {
    for (int q = 0; q < kThreadRows; ++q) {
      const Place p = pixel_of(t, q);
      if (!is_visible(v, p)) continue;
      for (int c = 0; c < C; ++c) a.image[sample_at(a, v, p, c)] = pixels[t].value[q][c];
    }
  });
}

template <int C, bool ABSOLUTE>
inline void error_tile(const ThreadBlock<kTileThreads> &block, const RasterArguments &a, TileMemory<C> &memory) {
  const TileView v = tile_view(a, block.index());
  PerThread<Pixels<C>, kTileThreads> pixels;
  draw_tile<C>(block, a, v, memory, pixels);
  compare_tile<C, ABSOLUTE>(block, a, v, memory, pixels);
  differentiate_tile<C>(block, a, v, memory);
}

}  // namespace

#define SGI_TILE_KERNELS(C)                                       \
  SGI_KERNEL(forward_##C, kTileThreads, RasterArguments) {        \
    SGI_SHARED(TileMemory<C>, memory);                            \
    forward_tile<C>(block, a, memory);                            \
  }                                                               \
  SGI_KERNEL(error_##C, kTileThreads, RasterArguments) {          \
    SGI_SHARED(TileMemory<C>, memory);                            \
    error_tile<C, false>(block, a, memory);                       \
  }                                                               \
  SGI_KERNEL(absolute_error_##C, kTileThreads, RasterArguments) { \
    SGI_SHARED(TileMemory<C>, memory);                            \
    error_tile<C, true>(block, a, memory);                        \
  }
SGI_TILE_KERNELS(1)
SGI_TILE_KERNELS(2)
SGI_TILE_KERNELS(3)
SGI_TILE_KERNELS(4)
#undef SGI_TILE_KERNELS

}  // namespace sgi
