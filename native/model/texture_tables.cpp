#include "model/texture_tables.hpp"

#include <algorithm>

#include "model/texture_bins.hpp"

namespace sgi {

std::optional<TextureTables> texture_tables(const Texture &texture, const OutputAxis &x, const OutputAxis &y,
                                            const float *mix) {
  const TextureAxis along(x, texture.width, true, {texture.corner, texture.log_size, texture.count});
  const TextureAxis downward(y, texture.height, false, {texture.corner + 1, texture.log_size, texture.count});
  const TextureBins bins(texture, along, downward, {kTableBlock, kTableBlock, x.count, y.count});
  const int64_t blocks = bins.across * bins.down, pairs = bins.last(blocks - 1) - bins.first(0);
  const std::vector<float> &across = along.all(), &down = downward.all();
  if (std::max({bins.begin(texture.count), pairs, int64_t(across.size()), int64_t(down.size())}) > INT32_MAX)
    return std::nullopt;
  TextureTables tables{texture.amplitudes, bins.begin(texture.count), mix, across, down, {}, {0}, {}, bins.across};
  for (int64_t i = 0; i < texture.count; ++i) {
    const CellAxis *h = along.cells(texture.corner[2 * i], texture.log_size[i]);
    const CellAxis *v = downward.cells(texture.corner[2 * i + 1], texture.log_size[i]);
    const CellAxis none{};
    const CellAxis &a = h && v ? *h : none, &b = h && v ? *v : none;  // of one that no block shows
    for (const int64_t field :
         {int64_t(1) << texture.log_size[i], bins.begin(i), a.first, a.count, a.at, a.stride, b.first, b.count, b.at})
      tables.cells.push_back(int32_t(field));
  }
  for (int64_t block = 0; block < blocks; ++block) {
    for (const int64_t *cell = bins.first(block); cell != bins.last(block); ++cell)
      tables.shown.push_back(int32_t(*cell));
    tables.start.push_back(int32_t(tables.shown.size()));
  }
  return tables;
}

}  // namespace sgi
