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

// The Gaussian at the scale at which it is rendered. Only cells shrink with a level of the pyramid; the least variance
// stays a matter of the pixels that are rendered.
inline bool prepared(const RasterArguments &a, int i, Splat &splat, Ellipse &ellipse) {
  const float area = a.scale * a.scale, added = a.minimum * (1.0f - area);
  const float mean[2] = {a.means[2 * i] * a.scale, a.means[2 * i + 1] * a.scale};
  const float covariance[3] = {a.covariances[3 * i] * area + added, a.covariances[3 * i + 1] * area,
                               a.covariances[3 * i + 2] * area + added};
  return prepare(mean, covariance, a.cutoff, splat, ellipse);
}

}  // namespace
}  // namespace sgi
