// Sums over the tiles: gradients of Gaussians from the moments of their pairs, errors from those of the tiles.
#pragma once
#include "cuda/raster/tile_memory.hpp"
#include "raster/moments.hpp"

namespace sgi {
namespace {

// Adds the partials of a Gaussian in the order of its slots, and carries them to its mean and covariance.
template <int C>
inline void reduce_gaussian(const RasterArguments &a, int i) {
  constexpr int kSums = kPairMoments + C;
  const int begin = a.slot_start[i], pairs = pairs_of(a),
            end = a.slot_start[i + 1] < pairs ? a.slot_start[i + 1] : pairs;
  float sum[1 + kSums] = {};  // the first moment is nobody's
  for (int slot = begin; slot < end; ++slot)
    for (int k = 0; k < kSums; ++k) sum[1 + k] += a.partials[int64_t(slot) * kSums + k];
  for (int c = 0; c < C; ++c) a.grad_colours[int64_t(i) * C + c] = sum[kMoments + c];
  float mean[2] = {}, covariance[3] = {};
  if (begin < end) carry_moments(a.covariances + 3 * i, sum, mean, covariance);
  for (int k = 0; k < 2; ++k) a.grad_means[2 * i + k] = mean[k];
  for (int k = 0; k < 3; ++k) a.grad_covariances[3 * i + k] = covariance[k];
}

}  // namespace

#define SGI_REDUCE_KERNEL(C)                         \
  SGI_KERNEL(reduce_##C, 128, RasterArguments) {     \
    block.each([&](int t) {                          \
      const int i = block.index() * 128 + t;         \
      if (i < a.gaussians) reduce_gaussian<C>(a, i); \
    });                                              \
  }
SGI_REDUCE_KERNEL(1)
SGI_REDUCE_KERNEL(2)
SGI_REDUCE_KERNEL(3)
SGI_REDUCE_KERNEL(4)
#undef SGI_REDUCE_KERNEL

}  // namespace sgi
