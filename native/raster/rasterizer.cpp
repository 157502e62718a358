#include "raster/rasterizer.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "base/thread_pool.hpp"
#include "raster/moments.hpp"

namespace sgi {
namespace {

TileRect tile_rect(const View &view, int64_t tile) {
  TileRect r;
  r.x = (view.tile_x0() + static_cast<int>(tile % view.tiles_x())) * kTileWidth - view.x0;
  r.y = (view.tile_y0() + static_cast<int>(tile / view.tiles_x())) * kTileHeight - view.y0;
  r.col0 = std::max(0, -r.x);
  r.row0 = std::max(0, -r.y);
  r.col1 = std::min(kTileWidth, view.width - r.x);
  r.row1 = std::min(kTileHeight, view.height - r.y);
  return r;
}

template <class Row>
void for_each_row(const View &view, const TileRect &r, int channels, Row row) {
  for (int c = 0; c < channels; ++c)
    for (int y = r.row0; y < r.row1; ++y)
      row((int64_t(c) * view.height + r.y + y) * view.width + r.x + r.col0, c * kTilePlane + y * kTileStride + r.col0,
          r.col1 - r.col0);
}

// Pixels of a tile, all 0. Rows begin where cache lines do, so that aligned vectors do not cross them.
class TileBuffer {
 public:
  explicit TileBuffer(int channels) : held_(channels * kTilePlane + kLine) {}
  float *data() {
    const auto at = reinterpret_cast<uintptr_t>(held_.data());
    return held_.data() + (-at / sizeof(float)) % kLine;
  }

 private:
  static constexpr size_t kLine = 64 / sizeof(float);
  static_assert(kTileStride % kLine == 0);
  std::vector<float> held_;
};

}  // namespace

Rasterizer::Rasterizer(Isa isa, int threads, int64_t most_pairs)
    : isa_(isa), kernel_(kernel_for<TileKernel>(isa)), gradient_kernel_(kernel_for<GradientKernel>(isa)),
      threads_(threads) {
  bins_.most_pairs = most_pairs;
}

int64_t Rasterizer::pairs() const { return static_cast<int64_t>(bins_.entries.size()); }

float *Rasterizer::partials_for(int64_t slots, int channels) {
  const int64_t size = slots * (kMoments + channels);
  if (size > partials_size_) {
    partials_.reset(new float[size + size / 4]);
    partials_size_ = size + size / 4;
  }
  return partials_.get();
}

// Calls finish(a tile's channels, where it is, the planes behind its first pixel or null) for all tiles.
template <class Finish>
void Rasterizer::draw_tiles(const Gaussians &g, const View &view, float cutoff, const GroupPlanes &behind,
                            Finish finish) {
  bin_gaussians(g.means, g.covariances, g.count, view, cutoff, threads_, bins_);
  const int64_t tiles_x = view.tiles_x(), tiles_y = view.tiles_y();
  const int64_t across = (tiles_x + kGroupTiles - 1) / kGroupTiles, down = (tiles_y + kGroupTiles - 1) / kGroupTiles;
  parallel_for(across * down, threads_, [&](int64_t group) {
    thread_local std::vector<float> memory;
    const int64_t column = group % across, row = group / across, left = column * kGroupTiles, top = row * kGroupTiles;
    if (behind && memory.size() < size_t(g.channels) * kGroupPlane) memory.resize(size_t(g.channels) * kGroupPlane);
    const bool has_planes = behind && behind(column, row, memory.data());
    for (int64_t y = top; y < std::min(tiles_y, top + kGroupTiles); ++y)
      for (int64_t x = left; x < std::min(tiles_x, left + kGroupTiles); ++x) {
        TileBuffer buffer(g.channels);
        const int64_t tile = y * tiles_x + x, begin = bins_.tile_start[tile];
        const TileRect r = tile_rect(view, tile);
        kernel_.forward(bins_.entries.data() + begin, bins_.tile_start[tile + 1] - begin, bins_.splats.data(),
                        g.colours, g.channels, r.x + view.x0, r.y + view.y0, least_height(cutoff), buffer.data());
        const int64_t at = (y - top) * kTileHeight * kGroupStride + (x - left) * kTileWidth;
        finish(buffer.data(), r, has_planes ? memory.data() + at : nullptr);
      }
  });
}

void Rasterizer::forward(const Gaussians &g, const View &view, float cutoff, float *image) {
  draw_tiles(g, view, cutoff, nullptr, [&](const float *tile, const TileRect &r, const float *) {
    for_each_row(view, r, g.channels,
                 [&](int64_t to, int from, int n) { std::memcpy(image + to, tile + from, n * sizeof(float)); });
  });
}

template <class Sink>
void Rasterizer::draw_onto(const Gaussians &g, const View &view, float cutoff, const Background &background,
                           const GroupPlanes &behind, const Sink &sink, FinishTile<Sink> finish) {
  draw_tiles(g, view, cutoff, behind, [&](const float *tile, const TileRect &r, const float *planes) {
    Background of_tile = background;
    of_tile.planes = planes, of_tile.plane = kGroupPlane, of_tile.plane_row = kGroupStride;
    finish(tile, g.channels, r, of_tile, sink);
  });
}

void Rasterizer::draw(const Gaussians &g, const View &view, float cutoff, const Background &background,
                      const GroupPlanes &behind, const Samples &samples) {
  draw_onto(g, view, cutoff, background, behind, samples, kernel_for<FinishKernel>(isa_).finish);
}

void Rasterizer::draw(const Gaussians &g, const View &view, float cutoff, const Background &background,
                      const GroupPlanes &behind, const ChannelPlanes &planes) {
  draw_onto(g, view, cutoff, background, behind, planes, kernel_for<FinishKernel>(isa_).finish_channels);
}

Errors Rasterizer::error(const Gaussians &g, const View &view, float cutoff, const Comparison &with,
                         const Gradients &out) {
  bin_gaussians(g.means, g.covariances, g.count, view, cutoff, threads_, bins_);
  float *partials = partials_for(pairs(), g.channels);
  std::vector<Errors> errors(int64_t(view.tiles_x()) * view.tiles_y());
  parallel_for(int64_t(errors.size()), threads_, [&](int64_t tile) {
    TileBuffer buffer(g.channels);
    const TileRect r = tile_rect(view, tile);
    const int64_t begin = bins_.tile_start[tile], n = bins_.tile_start[tile + 1] - begin;
    const Entry *entries = bins_.entries.data() + begin;
    const auto prefetch = [&](const float *plane, int channels) {
      for_each_row(view, r, channels, [&](int64_t from, int, int count) {
        for (int x = 0; x < count; x += 16) __builtin_prefetch(plane + from + x);
      });
    };
    prefetch(with.target, g.channels);
    if (with.weights) prefetch(with.weights, 1);
    const int x0 = r.x + view.x0, y0 = r.y + view.y0;
    gradient_kernel_.forward(entries, n, bins_.splats.data(), g.colours, g.channels, x0, y0, least_height(cutoff),
                             buffer.data());
    errors[tile] = gradient_kernel_.compare(buffer.data(), g.channels, r, with, view.width, view.height);
    gradient_kernel_.backward(entries, n, bins_.splats.data(), g.colours, g.channels, x0, y0, buffer.data(), partials);
  });
  reduce(g, out);
  Errors total{};
  for (const Errors &some : errors) {
    total.loss += some.loss;
    total.squared += some.squared;
  }
  total.loss *= with.weight;
  return total;
}

// Sums the partials of every Gaussian in slot order and carries them through the inverse of the covariance.
void Rasterizer::reduce(const Gaussians &g, const Gradients &out) {
  const int stride = kMoments + g.channels;
  constexpr int64_t kChunk = 1024;
  parallel_for((g.count + kChunk - 1) / kChunk, threads_, [&](int64_t chunk) {
    std::vector<float> sum(stride);
    for (int64_t i = chunk * kChunk; i < std::min(g.count, (chunk + 1) * kChunk); ++i) {
      std::fill(sum.begin(), sum.end(), 0.0f);
      for (int64_t slot = bins_.slot_start[i]; slot < bins_.slot_start[i + 1]; ++slot)
        for (int k = 0; k < stride; ++k) sum[k] += partials_[slot * stride + k];
      std::copy(sum.begin() + kMoments, sum.end(), out.colours + i * g.channels);
      if (bins_.slot_start[i] == bins_.slot_start[i + 1]) {
        out.means[2 * i] = out.means[2 * i + 1] = 0;
        out.covariances[3 * i] = out.covariances[3 * i + 1] = out.covariances[3 * i + 2] = 0;
        continue;
      }
      carry_moments(g.covariances + 3 * i, sum.data(), out.means + 2 * i, out.covariances + 3 * i);
    }
  });
}

}  // namespace sgi
