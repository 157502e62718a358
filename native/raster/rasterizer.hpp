// The additive rasteriser I(x) = sum_i c_i G_i(x) and its gradients, tile by tile.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "raster/binning.hpp"
#include "raster/finish_kernel.hpp"

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

// Holds the bins and the partial sums of one picture, so that a backward pass reuses what its forward pass found and
// repeated steps reuse the memory. Not safe for use by two threads at once.
class Rasterizer {
 public:
  // A call throws std::overflow_error where more than `most_pairs` (tile, Gaussian) pairs
  // would have to be listed: hostile Gaussians must not take all memory.
  Rasterizer(Isa isa, int threads, int64_t most_pairs);

  // Draws into image [C, height, width].
  void forward(const Gaussians &g, const View &view, float cutoff, float *image);
  // Draws onto a background and stores samples, tile by tile: there is no image of floats in between.
  void draw(const Gaussians &g, const View &view, float cutoff, const Background &background, const Samples &samples);
  // Gradients of the last forward's Gaussians from dL/dI = grad [C, height, width].
  void backward(const Gaussians &g, const View &view, const float *grad, const Gradients &out);
  // One pass over the tiles: draws, returns sum over pixels and channels of weight * (I - target)^2 and its gradients.
  double squared_error(const Gaussians &g, const View &view, float cutoff, const float *target, float weight,
                       const Gradients &out);
  // The same with weights [height, width] of the pixels: the gradients are those of the weighted sum.
  SquaredErrors weighted_squared_error(const Gaussians &g, const View &view, float cutoff, const float *target,
                                       const float *weights, const Gradients &out);
  // One pass over the tiles: draws, returns the sums of |I - target| and its square, and the gradients of weight times
  // the former.
  AbsoluteErrors absolute_error(const Gaussians &g, const View &view, float cutoff, const float *target, float weight,
                                const Gradients &out);

  Isa isa() const { return isa_; }
  int64_t pairs() const;  // (tile, Gaussian) pairs of the last forward

 private:
  // Draws tile by tile, lets `compare(tile number, drawn tile, rect)` turn it into dL/dI, and writes the gradients.
  template <class Compare>
  void differentiate(const Gaussians &g, const View &view, float cutoff, const float *target, const Gradients &out,
                     Compare compare);
  void reduce(const Gaussians &g, const Gradients &out);
  float *partials_for(int64_t slots, int channels);

  const Isa isa_;
  const TileKernel &kernel_;
  int threads_;
  Bins bins_;
  std::unique_ptr<float[]> partials_;
  int64_t partials_size_ = 0;
};

}  // namespace sgi
