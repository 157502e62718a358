// The additive rasteriser I(x) = sum_i c_i G_i(x) and its gradients, tile by tile.
#pragma once
#include <cstdint>
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

// Holds the bins and the partial sums of one picture, so that repeated steps reuse the memory. Not safe for use by two
// threads at once.
class Rasterizer {
 public:
  // A call throws std::overflow_error where more than `most_pairs` (tile, Gaussian) pairs
  // would have to be listed: hostile Gaussians must not take all memory.
  Rasterizer(Isa isa, int threads, int64_t most_pairs);

  // Draws into image [C, height, width].
  void forward(const Gaussians &g, const View &view, float cutoff, float *image);
  // Draws onto a background and stores samples, tile by tile: there is no image of floats in between.
  void draw(const Gaussians &g, const View &view, float cutoff, const Background &background, const Samples &samples);
  // One pass over the tiles: draws, compares, and returns the loss, with its weight, the sum of (I - target)^2, and the
  // loss's gradients.
  Errors error(const Gaussians &g, const View &view, float cutoff, const Comparison &with, const Gradients &out);

  Isa isa() const { return isa_; }
  int64_t pairs() const;  // (tile, Gaussian) pairs of the last forward

 private:
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
