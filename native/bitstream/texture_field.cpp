#include "bitstream/texture_field.hpp"

#include <algorithm>
#include <array>

namespace sgi {

TextureField::TextureField(int64_t roots_across, int64_t roots_down, int channels_)
    : width(roots_across << kTextureRoot), height(roots_down << kTextureRoot), channels(channels_),
      log_size(size_t((width / kUnit) * (height / kUnit))), contrast(size_t(roots_across * roots_down)),
      symbols(size_t(channels * width * height)), extent(size_t(channels) * log_size.size()) {}

void TextureField::mark(const TextureCell &cell, int log) {
  const int64_t across = cell.side() / kUnit;
  for (int64_t row = 0; row < across; ++row)
    std::fill_n(log_size.begin() + unit(cell.x, cell.y + row * kUnit), across, uint8_t(log));
}

void TextureField::set(const TextureCell &cell, int channel, const int16_t *values, int last) {
  const int side = cell.side(), across = side / kUnit;
  int16_t *to = at(channel, cell);
  for (int row = 0; row < side; ++row) std::copy_n(values + row * side, side, to + row * width);
  const auto reach = uint8_t(last < 0 ? 0 : 1 + last * 15 / (2 * side - 2));
  for (int64_t row = 0; row < across; ++row)
    std::fill_n(extent.begin() + channel * unit_count() + unit(cell.x, cell.y + row * kUnit), across, reach);
}

void TextureField::clear(const TextureCell &cell) {
  static const CellValues<int16_t> nothing{};
  mark(cell, 0);
  for (int channel = 0; channel < channels; ++channel) set(cell, channel, nothing.data(), -1);
}

const std::vector<Frequency> &texture_scan(int log) {
  static const auto scans = [] {
    std::array<std::vector<Frequency>, kTextureSizes> all;
    for (int l = kTextureLeast; l <= kTextureRoot; ++l) {
      const int side = 1 << l;
      for (int diagonal = 0; diagonal < 2 * side - 1; ++diagonal)
        for (int u = std::max(0, diagonal - side + 1); u <= std::min(diagonal, side - 1); ++u)
          all[l - kTextureLeast].push_back({int16_t((diagonal - u) * side + u), uint8_t(u), uint8_t(diagonal - u)});
    }
    return all;
  }();
  return scans[log - kTextureLeast];
}

int last_diagonal(const int16_t *values, int log) {
  const int side = 1 << log;
  int last = -1;
  for (int v = 0; v < side; ++v)
    for (int u = side - 1; u >= 0 && u + v > last; --u)
      if (values[v * side + u]) last = u + v;
  return last;
}

}  // namespace sgi
