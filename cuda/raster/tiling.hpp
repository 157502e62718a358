// What the kernels of the rasteriser share: tiles, and Gaussians as tiles read them.
#pragma once
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"
#include "raster/ellipse.hpp"

namespace sgi {

constexpr int kTileColumns = 32, kTileRows = 16;  // pixels

using CudaView = TiledView<kTileColumns, kTileRows>;

namespace {

struct TileSplat : Bell {
  Ellipse ellipse;
};

inline CudaView view_of(const RasterArguments &a) { return {a.x0, a.y0, a.width, a.height}; }

// How many pairs there are, as far as memory goes.
inline int pairs_of(const RasterArguments &a) {
  const int pairs = a.slot_start[a.gaussians];
  return pairs < a.capacity ? pairs : a.capacity;
}

inline bool prepared(const RasterArguments &a, int i, Splat &splat, Ellipse &ellipse) {
  return prepare(a.means + 2 * i, a.covariances + 3 * i, a.cutoff, splat, ellipse);
}

}  // namespace
}  // namespace sgi
