// Which Gaussians touch which 16x16 tile.
#pragma once
#include <cstdint>
#include <vector>

#include "kernel.hpp"

namespace sgi {

// A crop of the plane in whole pixels. Tiles are anchored to the plane, not to the crop, so that a crop of a picture
// equals the picture's crop to the last bit.
struct View {
  int x0, y0, width, height;
  int tile_x0() const { return floor_tile(x0); }
  int tile_y0() const { return floor_tile(y0); }
  int tiles_x() const { return floor_tile(x0 + width - 1) - tile_x0() + 1; }
  int tiles_y() const { return floor_tile(y0 + height - 1) - tile_y0() + 1; }
  static int floor_tile(int v) { return v >= 0 ? v / kTile : -((-v + kTile - 1) / kTile); }
};

struct Bins {
  std::vector<Splat> splats;          // [N]
  std::vector<int64_t> slot_start;    // [N + 1] first slot of every Gaussian
  std::vector<uint32_t> slot_tile;    // [slots] tile of every slot
  std::vector<int64_t> tile_start;    // [tiles + 1] first entry of every tile
  std::vector<Entry> entries;         // [slots] ordered by tile, then by Gaussian
  std::vector<int64_t> scratch;
};

// Fills `bins` for `n` Gaussians: means [N, 2] pixels, covariances [N, 3] (xx, xy, yy) pixels^2. A Gaussian reaches as
// far as `cutoff` standard deviations; one that is not finite or not positive definite touches nothing.
void bin_gaussians(const float *means, const float *covariances, int64_t n, const View &view, float cutoff, int threads,
                   Bins &bins);

}  // namespace sgi
