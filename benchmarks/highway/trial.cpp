// Runs the product's kernels and the Highway kernels in turn on the same Gaussians and tiles. Prints how far their
// results lie apart and the processor time of each. Arguments: turns, width, height.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <random>
#include <vector>

#include "binning.hpp"
#include "kernel.hpp"

namespace sgi {

std::vector<TileKernel> highway_kernels();

// Stands in for the thread pool: kernels are measured on one thread.
void parallel_for(int64_t n, int, const std::function<void(int64_t)> &body) {
  for (int64_t i = 0; i < n; ++i) body(i);
}

namespace {

constexpr int kChannels = 3;

// Gaussians spread evenly, tile after tile: deviations of 0.6 to 1.4 `sigma` pixels at any angle.
struct Scene {
  std::vector<float> means, covariances, colours, target;
  View view;
  Bins bins;

  Scene(int64_t count, double sigma, int width, int height) : view{0, 0, width, height} {
    std::mt19937 random(1);
    const auto uniform = [&] { return random() / 4294967296.0; };
    const auto variance = [&] { return std::pow(sigma * (0.6 + 0.8 * uniform()), 2); };
    const int64_t nx = view.tiles_x(), tiles = nx * view.tiles_y();
    for (int64_t i = 0; i < count; ++i) {
      const int64_t tile = i * tiles / count;
      means.push_back(float((tile % nx + uniform()) * kTileWidth));
      means.push_back(float((tile / nx + uniform()) * kTileHeight));
      const double s = variance(), t = variance(), angle = 3.14159265 * uniform();
      const double c = std::cos(angle), n = std::sin(angle);
      for (double v : {c * c * s + n * n * t, c * n * (s - t), n * n * s + c * c * t}) covariances.push_back(float(v));
      for (int k = 0; k < kChannels; ++k) colours.push_back(float(uniform() - 0.5));
    }
    for (int64_t i = 0; i < int64_t(kChannels) * width * height; ++i) target.push_back(float(uniform()));
    bins.most_pairs = int64_t(1) << 31;
    bin_gaussians(means.data(), covariances.data(), count, view, 3.5f, 1, bins);
  }
};

// A kernel, what it computed last, and the seconds that each turn took: the forward pass alone, then the fused pass
// (forward, squared error, backward) tile by tile, as in a step of the fit.
struct Runner {
  TileKernel kernel;
  std::vector<float> tiles = {}, partials = {};
  double loss = 0;
  std::vector<double> forward = {}, fused = {};

  void run(const Scene &s) {
    const View &v = s.view;
    const int64_t count = int64_t(v.tiles_x()) * v.tiles_y(), size = kChannels * kTilePlane;
    tiles.assign(count * size, 0.0f);
    partials.resize(s.bins.entries.size() * (kMoments + kChannels));
    std::vector<float> work(size);
    const Splat *splats = s.bins.splats.data();
    const float *colours = s.colours.data();
    const auto each_tile = [&](auto body) {
      const std::clock_t start = std::clock();
      for (int64_t tile = 0; tile < count; ++tile) {
        const int x = int(tile % v.tiles_x()) * kTileWidth, y = int(tile / v.tiles_x()) * kTileHeight;
        const TileRect r{x, y, 0, std::min(kTileWidth, v.width - x), 0, std::min(kTileHeight, v.height - y)};
        const int64_t begin = s.bins.tile_start[tile];
        body(tile, r, s.bins.entries.data() + begin, s.bins.tile_start[tile + 1] - begin);
      }
      return double(std::clock() - start) / CLOCKS_PER_SEC;
    };
    forward.push_back(each_tile([&](int64_t tile, const TileRect &r, const Entry *entries, int64_t n) {
      kernel.forward(entries, n, splats, colours, kChannels, r.x, r.y, tiles.data() + tile * size);
    }));
    loss = 0;
    fused.push_back(each_tile([&](int64_t, const TileRect &r, const Entry *entries, int64_t n) {
      std::fill(work.begin(), work.end(), 0.0f);
      kernel.forward(entries, n, splats, colours, kChannels, r.x, r.y, work.data());
      loss += kernel.compare(work.data(), kChannels, r, s.target.data(), v.width, v.height, 1.0f);
      kernel.backward(entries, n, splats, colours, kChannels, r.x, r.y, work.data(), partials.data());
    }));
  }
};

// The largest difference by the largest value.
double apart(const std::vector<float> &a, const std::vector<float> &b) {
  double difference = 0, value = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    if (!std::isfinite(b[i])) return INFINITY;
    difference = std::max(difference, std::abs(double(a[i]) - b[i]));
    value = std::max(value, std::abs(double(a[i])));
  }
  return difference / value;
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + v.size() / 2, v.end());
  return v[v.size() / 2];
}

// One row per kernel. A Highway kernel is compared with the product's kernel of as many lanes, since wider vectors draw
// farther beyond the cutoff.
bool report(const std::vector<Runner> &runners, int turns) {
  std::printf("kernel            lanes  forward ms  fused ms  differs by: tiles, loss, gradients  time ratios\n");
  bool agree = true;
  for (const Runner &r : runners) {
    const Runner &base = *std::find_if(runners.begin(), runners.end(),
                                       [&](const Runner &o) { return o.kernel.lanes == r.kernel.lanes; });
    const double tiles = apart(base.tiles, r.tiles), loss = std::abs(r.loss / base.loss - 1);
    const double gradients = apart(base.partials, r.partials);
    agree = agree && tiles < 1e-6 && loss < 1e-6 && gradients < 1e-6;
    std::vector<double> forward, fused;
    for (int turn = 0; turn < turns; ++turn) {
      forward.push_back(r.forward[turn] / base.forward[turn]);
      fused.push_back(r.fused[turn] / base.fused[turn]);
    }
    std::printf("%-17s %5d %11.2f %9.2f %17.1e %.1e %.1e %13.3f %.3f\n", r.kernel.name, r.kernel.lanes,
                1e3 * median(r.forward), 1e3 * median(r.fused), tiles, loss, gradients, median(forward), median(fused));
  }
  return agree;
}

}  // namespace
}  // namespace sgi

int main(int argc, char **argv) {
  const int turns = argc > 1 ? std::max(1, std::atoi(argv[1])) : 15;
  const int width = argc > 2 ? std::atoi(argv[2]) : 1024, height = argc > 3 ? std::atoi(argv[3]) : 672;
  std::vector<sgi::TileKernel> kernels = {sgi::portable_kernel()};
#ifdef SGI_X86
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) kernels.push_back(sgi::avx2_kernel());
  if (__builtin_cpu_supports("avx512bw")) kernels.push_back(sgi::avx512_kernel());
#endif
  for (const sgi::TileKernel &kernel : sgi::highway_kernels()) kernels.push_back(kernel);
  bool agree = true;
  for (const auto &[per_pixel, sigma] : {std::pair{0.018, 4.0}, std::pair{0.18, 1.3}}) {
    const sgi::Scene scene(static_cast<int64_t>(per_pixel * width * height), sigma, width, height);
    std::printf("%d x %d, %zu Gaussians of sigma %.1f\n", width, height, scene.means.size() / 2, sigma);
    std::vector<sgi::Runner> runners;
    for (const sgi::TileKernel &kernel : kernels) runners.push_back({kernel});
    for (int turn = 0; turn < turns; ++turn)  // forwards and backwards, so that no kernel gains from its place
      for (size_t i = 0; i < runners.size(); ++i) runners[turn % 2 ? runners.size() - 1 - i : i].run(scene);
    agree = sgi::report(runners, turns) && agree;
  }
  std::puts(agree ? "results agree" : "RESULTS DIFFER");
  return agree ? 0 : 1;
}
