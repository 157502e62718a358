// Which Gaussians touch which tile.
#pragma once
#include <cstdint>
#include <vector>

#include "raster/ellipse.hpp"
#include "raster/tile_kernel.hpp"

namespace sgi {

using View = TiledView<kTileWidth, kTileHeight>;

struct Bins {
  int64_t most_pairs;                              // (tile, Gaussian) pairs that one call may list
  std::vector<Splat> splats;                       // [N]
  std::vector<int64_t> slot_start;                 // [N + 1] first slot of every Gaussian
  std::vector<std::vector<uint32_t>> chunk_tiles;  // tiles of the slots of each run of Gaussians, in slot order
  std::vector<int64_t> tile_start;                 // [tiles + 1] first entry of every tile
  std::vector<Entry> entries;                      // [slots] ordered by tile, then by Gaussian
  std::vector<int64_t> scratch;
};

// Prepares one Gaussian: mean [2] pixels, covariance [3] (xx, xy, yy) pixels^2. False for one that is not drawn.
bool prepare_splat(const float *mean, const float *covariance, float cutoff, Splat &splat);

// Fills `bins` for `n` Gaussians: means [N, 2] pixels, covariances [N, 3] (xx, xy, yy) pixels^2. A Gaussian reaches as
// far as `cutoff` standard deviations; one that is not finite or not positive definite touches nothing. Throws
// std::overflow_error for more than `bins.most_pairs` (tile, Gaussian) pairs.
void bin_gaussians(const float *means, const float *covariances, int64_t n, const View &view, float cutoff, int threads,
                   Bins &bins);

}  // namespace sgi
