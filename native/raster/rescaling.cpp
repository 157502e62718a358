#include "raster/rescaling.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"

namespace sgi {

GaussianSet rescaled(const Gaussians &g, const Rescaling &x, const Rescaling &y, double pixel_variance, int threads) {
  const double sx = x.scale, sy = y.scale;
  constexpr int64_t kRun = 4096;
  GaussianSet out{std::vector<float>(2 * g.count), std::vector<float>(3 * g.count),
                  std::vector<float>(g.channels * g.count), g.channels};
  const double wider = pixel_variance * std::max(0.0, 1 - sx * sx);
  const double higher = pixel_variance * std::max(0.0, 1 - sy * sy);
  parallel_for((g.count + kRun - 1) / kRun, threads, [&](int64_t run) {
    for (int64_t i = run * kRun; i < std::min(g.count, (run + 1) * kRun); ++i) {
      out.means[2 * i] = float(g.means[2 * i] * sx - x.origin);
      out.means[2 * i + 1] = float(g.means[2 * i + 1] * sy - y.origin);
      double xx = g.covariances[3 * i] * (sx * sx), yy = g.covariances[3 * i + 2] * (sy * sy);
      const double xy = g.covariances[3 * i + 1] * (sx * sy);
      const double before = xx * yy - xy * xy;
      xx += wider;
      yy += higher;
      const double fade = std::sqrt(before > 0 ? before / (xx * yy - xy * xy) : 0.0);
      out.covariances[3 * i] = float(xx);
      out.covariances[3 * i + 1] = float(xy);
      out.covariances[3 * i + 2] = float(yy);
      for (int c = 0; c < g.channels; ++c)
        out.colours[g.channels * i + c] = float(g.colours[g.channels * i + c] * fade);
    }
  });
  return out;
}

}  // namespace sgi
