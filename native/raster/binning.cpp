#include "raster/binning.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int64_t kChunk = 1024;

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
}

}  // namespace sgi
