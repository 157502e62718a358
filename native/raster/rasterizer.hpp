// The additive rasteriser I(x) = sum_i c_i G_i(x) and its gradients, tile by tile.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "raster/binning.hpp"
#include "raster/finish_kernel.hpp"
#include "raster/gradient_kernel.hpp"

namespace sgi {

struct Gaussians {
  const float *means;        // [N, 2] pixels
  const float *covariances;  // [N, 3] xx, xy, yy, pixels^2
  const float *colours;      // [N, C]
  int64_t count;
  int channels;
};

struct Gradients {
  float *means;        // [N, 2]
  float *covariances;  // [N, 3]
  float *colours;      // [N, C]
};

// Tiles are drawn in groups, so that what lies behind many of them is drawn once, in the cache.
constexpr int kGroupTiles = 2, kGroupWidth = kGroupTiles * kTileWidth, kGroupHeight = kGroupTiles * kTileHeight;
constexpr int kGroupStride = kGroupWidth + 16;  // of a row of a group; a vector may begin at any column
constexpr int kGroupPlane = kGroupHeight * kGroupStride;

// Writes what else lies behind a group [C, kGroupHeight, kGroupStride], from its first pixel on. False for nothing. The
// first group begins where the view's first tile does.
using GroupPlanes = std::function<bool(int64_t column, int64_t row, float *planes)>;

// Holds the bins and the partial sums of one picture, so that repeated steps reuse the memory. Not safe for use by two
// threads at once.
class Rasterizer {
 public:
  // A call throws std::overflow_error where more than `most_pairs` (tile, Gaussian) pairs
  // would have to be listed: hostile Gaussians must not take all memory.
  Rasterizer(Isa isa, int threads, int64_t most_pairs);

  // Draws into image [C, height, width].
  void forward(const Gaussians &g, const View &view, float cutoff, float *image);
  // Draws onto a background without planes, and onto those of groups, and stores samples, tile by tile: there is no
  // image of floats in between. behind: empty for none.
  void draw(const Gaussians &g, const View &view, float cutoff, const Background &background, const GroupPlanes &behind,
            const Samples &samples);
  // The same, but channels are left as they are.
  void draw(const Gaussians &g, const View &view, float cutoff, const Background &background, const GroupPlanes &behind,
            const ChannelPlanes &planes);
  // One pass over the tiles: draws, compares, and returns the loss, with its weight, the sum of (I - target)^2, and the
  // loss's gradients.
  Errors error(const Gaussians &g, const View &view, float cutoff, const Comparison &with, const Gradients &out);

  Isa isa() const { return isa_; }
  int64_t pairs() const;  // (tile, Gaussian) pairs of the last forward

 private:
  template <class Finish>
  void draw_tiles(const Gaussians &g, const View &view, float cutoff, const GroupPlanes &behind, Finish finish);
  template <class Sink>
  void draw_onto(const Gaussians &g, const View &view, float cutoff, const Background &background,
                 const GroupPlanes &behind, const Sink &sink, FinishTile<Sink> finish);
  void reduce(const Gaussians &g, const Gradients &out);
  float *partials_for(int64_t slots, int channels);

  const Isa isa_;
  const TileKernel &kernel_;
  const GradientKernel &gradient_kernel_;
  int threads_;
  Bins bins_;
  std::unique_ptr<float[]> partials_;
  int64_t partials_size_ = 0;
};

}  // namespace sgi
