#include "rdoq/coordinate_descent.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <vector>

#include "base/thread_pool.hpp"
#include "raster/binning.hpp"

namespace sgi {
namespace {

constexpr Window kCorner{0, 0, 1, 1, kWindowPadding};  // stands for no pixels at all

// 0 to count - 1 by reversed bits: neighbours are then far apart, so that threads need not wait for each other.
std::vector<int32_t> scattered(int64_t count) {
  std::vector<int32_t> order;
  order.reserve(count);
  int bits = 0;
  while ((int64_t(1) << bits) < count) ++bits;
  for (int64_t i = 0; i < (int64_t(1) << bits); ++i) {
    int64_t reversed = 0;
    for (int b = 0; b < bits; ++b) reversed |= (i >> b & 1) << (bits - 1 - b);
    if (reversed < count) order.push_back(static_cast<int32_t>(reversed));
  }
  return order;
}

template <class Body>
void for_each_chunk(int64_t count, int threads, Body body) {
  constexpr int64_t kChunk = 64;
  parallel_for((count + kChunk - 1) / kChunk, threads,
               [&](int64_t chunk) { body(chunk * kChunk, std::min(count, (chunk + 1) * kChunk)); });
}

// How leaving out a Gaussian of this colour would change the squared error; draws it into the first of two planes.
double loss_without(const WindowKernel &kernel, const Residual &residual, const Window &w, const Splat &splat,
                    const float *colour, float *g) {
  kernel.draw(splat, w, g);
  const float *weighted = g;
  if (residual.weights) {
    kernel.weigh(residual.weights_in(w), w, g, g + w.size());
    weighted = g + w.size();
  }
  const double square = kernel.inner({g, w.stride}, w, weighted);
  double change = 0;
  for (int c = 0; c < residual.channels; ++c)
    change += colour[c] * (colour[c] * square + 2.0 * kernel.inner(residual.plane(c, w), w, weighted));
  return change;
}

}  // namespace

void search_seeds(const CodingModel &model, const SearchSettings &settings, const Residual &residual,
                  const SeedArrays &seeds, const SymbolArrays &out, int threads, Isa isa) {
  const WindowKernel &kernel = kernel_for<WindowKernel>(isa);
  const int d = model.attributes();
  const auto seed = [&](int64_t i) {
    return Seed{seeds.inputs + i * seeds.stride, seeds.values + i * d, seeds.centre + 2 * i, seeds.cell[i],
                seeds.log_size[i]};
  };
  std::vector<Window> windows(seeds.count);
  for_each_chunk(seeds.count, threads, [&](int64_t begin, int64_t end) {
    SeedSearch search(model, settings, kernel);
    for (int64_t i = begin; i < end; ++i) {
      windows[i] = search.reserve(seed(i), residual);
      if (windows[i].empty()) windows[i] = kCorner;
    }
  });
  for_each_window(windows, scattered(seeds.count), residual, threads, [&]() -> Worker {
    return [&, search = std::make_shared<SeedSearch>(model, settings, kernel)](int64_t i) {
      Coded best;
      out.change[i] = search->search(seed(i), windows[i], residual, best);
      std::copy_n(best.decoded, d, out.decoded + i * d);
      std::copy_n(best.symbols, d, out.symbols + i * d);
      std::copy_n(best.scale, d, out.scale + i * d);
    };
  });
}

void prune_gaussians(const Residual &residual, const Prunable &gaussians, float cutoff, int threads, Isa isa,
                     bool *pruned) {
  const WindowKernel &kernel = kernel_for<WindowKernel>(isa);
  std::vector<Splat> splats(gaussians.count);
  std::vector<Window> windows(gaussians.count);
  for (int64_t i = 0; i < gaussians.count; ++i) {
    const bool drawn = prepare_splat(gaussians.means + 2 * i, gaussians.covariances + 3 * i, cutoff, splats[i]);
    windows[i] = drawn ? window_around(splats[i], 1, 0, residual) : Window{};
    pruned[i] = windows[i].empty() && gaussians.price[i] > 0;
  }
  std::vector<int32_t> order(gaussians.count);
  std::iota(order.begin(), order.end(), 0);
  for_each_window(windows, order, residual, threads, [&]() -> Worker {
    return [&, plane = std::make_shared<std::vector<float>>()](int64_t i) {
      const Window &w = windows[i];
      plane->assign((residual.weights ? 2 : 1) * w.size(), 0.0f);
      float *g = plane->data();
      const float *colour = gaussians.colours + i * residual.channels;
      pruned[i] = loss_without(kernel, residual, w, splats[i], colour, g) < gaussians.price[i];
      if (!pruned[i]) return;
      for (int c = 0; c < residual.channels; ++c) kernel.subtract(residual.plane(c, w), w, -colour[c], g);
    };
  });
}

}  // namespace sgi
