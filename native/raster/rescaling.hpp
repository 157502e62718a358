// Gaussians at another scale: in output pixels and, where these are larger, filtered so that nothing aliases.
#pragma once
#include <vector>

#include "raster/rasterizer.hpp"

namespace sgi {

// Gaussians that are held here.
struct GaussianSet {
  std::vector<float> means, covariances, colours;  // [N, 2], [N, 3], [N, C]
  int channels = 0;

  int64_t count() const { return int64_t(means.size()) / 2; }
  int64_t memory() const { return 4 * int64_t(means.size() + covariances.size() + colours.size()); }
  Gaussians view() const { return {means.data(), covariances.data(), colours.data(), count(), channels}; }
};

// Places times `scale`, less `origin`: what is there in new pixels moves to 0.
struct Rescaling {
  double scale, origin;
};

// Those of a picture that is scaled along both axes. An axis that shrinks is convolved with what its new pixels cover
// beyond the old ones, a variance of 1 - scale^2 of `pixel_variance`; each keeps its integral.
GaussianSet rescaled(const Gaussians &g, const Rescaling &x, const Rescaling &y, double pixel_variance, int threads);

}  // namespace sgi
