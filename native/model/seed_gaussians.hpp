// The Gaussians of seeds that hold them as they are: colours, log-covariances and offsets, without decoders.
#pragma once
#include <cstdint>

#include "base/inline.hpp"
#include "model/constants.hpp"

namespace sgi {

enum class Isa;

struct SeedsView {
  const int32_t *half_pixels;  // [N, 2] centres
  const int8_t *log_size;      // [N] log2 of the cell's side
};

// What a seed's d_A attributes are: those of its one Gaussian, a colour, a shape, an offset.
struct SeedModel {
  int channels;  // C

  SGI_INLINE int attributes() const { return channels + 5; }
  SGI_INLINE int group_size(int g) const { return g == kColour ? channels : g == kShape ? 3 : 2; }
  SGI_INLINE int group_start(int g) const { return g == kColour ? 0 : g == kShape ? channels : channels + 3; }
};

struct SeedGaussians {
  float *means, *covariances, *colours;  // [N, 2] pixels, [N, 3] (xx, xy, yy) pixels², [N, C]
};

struct GaussianKernel {
  // Of the seeds [begin, end) of `count`; values [N, d_A].
  void (*evaluate)(const SeedModel &model, const SeedsView &seeds, int64_t count, const double *values, int64_t begin,
                   int64_t end, const SeedGaussians &out);
  static const GaussianKernel portable, avx2, avx512;
};

// Of all `count` seeds.
void seed_gaussians(const SeedModel &model, const SeedsView &seeds, int64_t count, const double *values, int threads,
                    Isa isa, const SeedGaussians &out);

}  // namespace sgi
