// What the threads of a tile's block share: its view, its Gaussians, its dL/dI.
#pragma once
#include "cuda/raster/tiling.hpp"

namespace sgi {

constexpr int kTileThreads = 128, kStaged = kTileThreads;             // Gaussians of a tile in shared memory at a time
constexpr int kSubWidth = kTileColumns / (kTileThreads / kWarp);      // columns of a warp
constexpr int kThreadRows = kTileColumns * kTileRows / kTileThreads;  // pixels of a thread, one below the other
static_assert(kSubWidth * kTileRows == kWarp * kThreadRows);
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

struct Place {
  int column, row;
};
// Of the first pixel of a thread; the others lie below it.
inline Place first_of(int t) {
  const int lane = t % kWarp;
  return {t / kWarp * kSubWidth + lane % kSubWidth, lane / kSubWidth * kThreadRows};
}
inline Place pixel_of(int t, int q) { return {first_of(t).column, first_of(t).row + q}; }

inline bool is_visible(const TileView &v, Place p) {
  return p.column >= v.first_column && p.column <= v.last_column && p.row >= v.first_row && p.row <= v.last_row;
}

template <int C>
inline void stage(const RasterArguments &a, int entry, StagedSplat<C> &to) {
  const int i = a.owner[a.slots[entry]];
  to.s = static_cast<const TileSplat *>(a.splats)[i];
  to.slot = a.slots[entry];
  for (int c = 0; c < C; ++c) to.colour[c] = a.colours[int64_t(i) * C + c];
}

}  // namespace
}  // namespace sgi
