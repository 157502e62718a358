#include "model/texture.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/thread_pool.hpp"
#include "model/texture_bins.hpp"
#include "model/texture_kernel.hpp"

namespace sgi {
namespace {

constexpr int64_t kBlockWidth = 128, kBlockHeight = 64;  // pixels that are rendered while they are in the cache
constexpr int64_t kBlockStride = kBlockWidth + kTexturePadding;
constexpr int64_t kRun = 256;

// The waves of a channel of a cell: rows and columns of amplitudes behind which all are zero.
struct Extent {
  uint8_t down, across;
};

Extent extent_of(const float *amplitudes, int side) {
  constexpr int kMax = 1 << kTextureRoot;
  uint32_t any[kMax] = {}, row[kMax];
  int down = 0, across = 0;
  for (int v = 0; v < side; ++v) {
    std::memcpy(row, amplitudes + v * side, side * sizeof(float));
    uint32_t some = 0;
    for (int u = 0; u < side; ++u) {
      some |= row[u];
      any[u] |= row[u];
    }
    if (some) down = v + 1;
  }
  for (int u = 0; u < side; ++u)
    if (any[u]) across = u + 1;
  return {uint8_t((down + 3) / 4 * 4), uint8_t(across)};  // the kernel takes four rows at a time
}

// Adds what a cell has in the block of columns x0 ... x1 and rows y0 ... y1 to its planes.
void add_cell(const Texture &texture, const float *amplitudes, const Extent *extents, int side, const TextureAxis &x,
              const TextureAxis &y, const CellAxis &h, const CellAxis &v, int64_t x0, int64_t x1, int64_t y0,
              int64_t y1, const TextureKernel &kernel, float *planes) {
  const int64_t left = std::max(x0, h.first), right = std::min(x1, h.first + h.count);
  const int64_t top = std::max(y0, v.first), bottom = std::min(y1, v.first + v.count);
  TexturePart part;
  part.side = side;
  part.across = x.values() + h.at + (left - h.first);
  part.across_stride = h.stride;
  part.down = y.values() + v.at + (top - v.first) * v.stride;
  part.rows = int(bottom - top);
  part.columns = int(right - left);
  for (int c = 0; c < texture.channels; ++c) {
    if (!extents[c].across) continue;
    part.amplitudes = amplitudes + c * side * side;
    part.waves_down = extents[c].down;
    part.waves_across = extents[c].across;
    kernel.add(part, planes + (c * kBlockHeight + top - y0) * kBlockStride + left - x0, kBlockStride);
  }
}

}  // namespace

void draw_texture(const Texture &texture, const OutputAxis &x, const OutputAxis &y, const float *mix, int threads,
                  Isa isa, float *planes) {
  const TextureKernel &kernel = kernel_for<TextureKernel>(isa);
  const TextureAxis along(x, texture.width, true, {texture.corner, texture.log_size, texture.count});
  const TextureAxis downward(y, texture.height, false, {texture.corner + 1, texture.log_size, texture.count});
  const TextureBins bins(texture, along, downward, {kBlockWidth, kBlockHeight, x.count, y.count});
  const int channels = texture.channels;
  std::vector<Extent> extents(texture.count * channels);
  parallel_for((texture.count + kRun - 1) / kRun, threads, [&](int64_t run) {
    for (int64_t i = run * kRun; i < std::min(texture.count, (run + 1) * kRun); ++i) {
      const int side = 1 << texture.log_size[i];
      if (!bins.has(i)) continue;
      for (int c = 0; c < channels; ++c)
        extents[i * channels + c] = extent_of(texture.amplitudes + bins.begin(i) + c * side * side, side);
    }
  });
  parallel_for(bins.across * bins.down, threads, [&](int64_t block) {
    const int64_t x0 = block % bins.across * kBlockWidth, x1 = std::min(x0 + kBlockWidth, x.count);
    const int64_t y0 = block / bins.across * kBlockHeight, y1 = std::min(y0 + kBlockHeight, y.count);
    std::vector<float> drawn(channels * kBlockHeight * kBlockStride);
    for (const int64_t *cell = bins.first(block); cell != bins.last(block); ++cell) {
      const int log_size = texture.log_size[*cell];
      add_cell(texture, texture.amplitudes + bins.begin(*cell), extents.data() + *cell * channels, 1 << log_size, along,
               downward, *along.cells(texture.corner[2 * *cell], log_size),
               *downward.cells(texture.corner[2 * *cell + 1], log_size), x0, x1, y0, y1, kernel, drawn.data());
    }
    constexpr int64_t kPlane = kBlockHeight * kBlockStride;
    const bool is_mixed = mix && bins.first(block) != bins.last(block);
    const auto of_planes = [&](int c, int64_t row) { return planes + (c * y.count + row) * x.count + x0; };
    for (int64_t row = y0; row < y1; ++row) {
      const float *from = drawn.data() + (row - y0) * kBlockStride;
      if (is_mixed) {
        float *const out[] = {of_planes(0, row), of_planes(1, row), of_planes(2, row)};
        kernel.mix(mix, from, kPlane, x1 - x0, out);
      }
      for (int c = is_mixed ? 3 : 0; c < channels; ++c)
        std::memcpy(of_planes(c, row), from + c * kPlane, (x1 - x0) * sizeof(float));
    }
  });
}

}  // namespace sgi
