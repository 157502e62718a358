#include "raster/binning.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int64_t kChunk = 1024;
constexpr float kLongestSpan = 8;  // rows; rounding errors grow with the square
constexpr float kLog2E = 1.44269504f;

// The ellipse of all points within the cutoff, relative to the centre.
struct Ellipse {
  float ry;          // half height
  float lean;        // dx of the axis of widths per dy
  float half_width;  // half width at the centre row
  float top_dy;      // dy at which the right end is reached

  // Right and left end of the part with dy in [lo, hi].
  void extent(float lo, float hi, float &left, float &right) const {
    right = edge(clamp(top_dy, lo, hi), 1.0f);
    left = edge(clamp(-top_dy, lo, hi), -1.0f);
  }

 private:
  float clamp(float dy, float lo, float hi) const {
    return std::min(std::max(dy, std::max(lo, -ry)), std::min(hi, ry));
  }
  float edge(float dy, float side) const {
    const float u = dy / ry;
    return lean * dy + side * half_width * std::sqrt(std::max(0.0f, 1.0f - u * u));
  }
};

bool prepare(const float *mean, const float *cov, float cutoff, Splat &s, Ellipse &e) {
  const double xx = cov[0], xy = cov[1], yy = cov[2];
  const double det = xx * yy - xy * xy;
  if (!(xx > 0 && yy > 0 && det > 1e-12 * xx * yy) || !std::isfinite(det) || !std::isfinite(mean[0]) ||
      !std::isfinite(mean[1]))
    return false;
  s.x = mean[0];
  s.y = mean[1];
  s.a = static_cast<float>(-0.5 * kLog2E * yy / det);
  s.b = static_cast<float>(kLog2E * xy / det);
  s.c = static_cast<float>(-0.5 * kLog2E * xx / det);
  s.k = std::exp2(2.0f * s.c);
  s.rx = cutoff * std::sqrt(cov[0]);
  s.ry = e.ry = cutoff * std::sqrt(cov[2]);
  s.lean = static_cast<float>(xy / xx);
  s.half_height = static_cast<float>(cutoff * std::sqrt(det / xx));
  s.low_dx = static_cast<float>(cutoff * xy / std::sqrt(yy));
  e.lean = static_cast<float>(xy / yy);
  e.half_width = static_cast<float>(cutoff * std::sqrt(det / yy));
  e.top_dy = static_cast<float>(cutoff * xy / std::sqrt(xx));
  // A start must not underflow (2^-126) if a later row of its run lies within the cutoff, 2^-(0.85 cutoff)^2: over
  // span - 1 rows sqrt(-log2 G) falls by at most sqrt(-c) (span - 1).
  const float headroom = std::max(0.0f, 11.2f - 0.85f * cutoff), fall = std::sqrt(-s.c);
  s.span = static_cast<int32_t>(std::min(kLongestSpan - 1.0f, headroom / fall)) + 1;
  return true;
}

// Calls visit(tile) for every tile of the view that the ellipse touches, in row-major order.
template <class Visit>
void for_each_tile(const Splat &s, const Ellipse &e, const View &view, Visit visit) {
  const int tx0 = view.tile_x0(), ty0 = view.tile_y0(), nx = view.tiles_x(), ny = view.tiles_y();
  // Pixel centres sit at +1/2: a tile covers centres from 1/2 to its size less 1/2.
  const auto first_tile = [](float edge, int size, int base) {
    return static_cast<int>(std::floor((std::max(-1e8f, std::min(1e8f, edge)) - (size - 0.5f)) / size + 1.0f)) - base;
  };
  const auto last_tile = [](float edge, int size, int base) {
    return static_cast<int>(std::floor((std::max(-1e8f, std::min(1e8f, edge)) - 0.5f) / size)) - base;
  };
  const int row0 = std::max(0, first_tile(s.y - e.ry, kTileHeight, ty0));
  const int row1 = std::min(ny - 1, last_tile(s.y + e.ry, kTileHeight, ty0));
  for (int row = row0; row <= row1; ++row) {
    const float lo = (ty0 + row) * float(kTileHeight) + 0.5f - s.y;
    float left, right;
    e.extent(lo, lo + (kTileHeight - 1), left, right);
    const int col0 = std::max(0, first_tile(s.x + left, kTileWidth, tx0));
    const int col1 = std::min(nx - 1, last_tile(s.x + right, kTileWidth, tx0));
    for (int col = col0; col <= col1; ++col) visit(static_cast<uint32_t>(row * nx + col));
  }
}

// Prepares every Gaussian and lists the tiles that each chunk of them touches; slot_start counts from the chunk's
// first.
void find_tiles(const float *means, const float *covariances, int64_t n, const View &view, float cutoff, int threads,
                Bins &bins) {
  const int64_t chunks = (n + kChunk - 1) / kChunk;
  bins.splats.resize(n);
  bins.slot_start.resize(n + 1);
  bins.chunk_tiles.resize(chunks);
  std::atomic<int64_t> pairs{0};
  parallel_for(chunks, threads, [&](int64_t chunk) {
    if (pairs > bins.most_pairs) return;
    std::vector<uint32_t> &tiles = bins.chunk_tiles[chunk];
    tiles.clear();
    for (int64_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i) {
      bins.slot_start[i] = static_cast<int64_t>(tiles.size());
      Ellipse ellipse;
      if (bins.slot_start[i] <= bins.most_pairs &&
          prepare(means + 2 * i, covariances + 3 * i, cutoff, bins.splats[i], ellipse))
        for_each_tile(bins.splats[i], ellipse, view, [&](uint32_t tile) { tiles.push_back(tile); });
    }
    pairs += static_cast<int64_t>(tiles.size());
  });
  if (pairs > bins.most_pairs) throw std::overflow_error("too many Gaussians in too many tiles: draw smaller crops");
}

}  // namespace

bool prepare_splat(const float *mean, const float *covariance, float cutoff, Splat &splat) {
  Ellipse ellipse;
  return prepare(mean, covariance, cutoff, splat, ellipse);
}

void bin_gaussians(const float *means, const float *covariances, int64_t n, const View &view, float cutoff, int threads,
                   Bins &bins) {
  const int64_t chunks = (n + kChunk - 1) / kChunk;
  bins.count = -1;
  find_tiles(means, covariances, n, view, cutoff, threads, bins);
  const auto chunk_end = [&](int64_t chunk) { return std::min(n, (chunk + 1) * kChunk); };
  int64_t slots = 0;
  for (int64_t chunk = 0; chunk < chunks; ++chunk) {
    for (int64_t i = chunk * kChunk; i < chunk_end(chunk); ++i) bins.slot_start[i] += slots;
    slots += static_cast<int64_t>(bins.chunk_tiles[chunk].size());
  }
  bins.slot_start[n] = slots;

  // Stable counting sort by tile: groups of chunks count their own, so the order never depends on the threads.
  const int64_t tiles = int64_t(view.tiles_x()) * view.tiles_y();
  const int64_t groups = std::max<int64_t>(1, std::min<int64_t>(chunks, 16));
  bins.scratch.assign(groups * tiles, 0);
  const auto for_each_chunk = [&](int64_t group, auto visit) {
    for (int64_t chunk = chunks * group / groups; chunk < chunks * (group + 1) / groups; ++chunk) visit(chunk);
  };
  parallel_for(groups, threads, [&](int64_t group) {
    int64_t *count = bins.scratch.data() + group * tiles;
    for_each_chunk(group, [&](int64_t chunk) {
      for (const uint32_t tile : bins.chunk_tiles[chunk]) ++count[tile];
    });
  });
  bins.tile_start.resize(tiles + 1);
  int64_t at = 0;
  for (int64_t tile = 0; tile < tiles; ++tile) {
    bins.tile_start[tile] = at;
    for (int64_t group = 0; group < groups; ++group) {
      const int64_t count = bins.scratch[group * tiles + tile];
      bins.scratch[group * tiles + tile] = at;
      at += count;
    }
  }
  bins.tile_start[tiles] = at;
  bins.entries.resize(slots);
  parallel_for(groups, threads, [&](int64_t group) {
    int64_t *next = bins.scratch.data() + group * tiles;
    for_each_chunk(group, [&](int64_t chunk) {
      const uint32_t *tile = bins.chunk_tiles[chunk].data();
      for (int64_t i = chunk * kChunk; i < chunk_end(chunk); ++i)
        for (int64_t slot = bins.slot_start[i]; slot < bins.slot_start[i + 1]; ++slot)
          bins.entries[next[*tile++]++] = {static_cast<int32_t>(i), static_cast<uint32_t>(slot)};
    });
  });
  bins.count = n;
  bins.view = view;
}

}  // namespace sgi
