#include "bitstream/texture_field.hpp"

#include <algorithm>
#include <array>

namespace sgi {

TextureField::TextureField(int64_t roots_across, int64_t roots_down, int channels_, KeptSymbols kept)
    : width(roots_across << kTextureRoot), height(roots_down << kTextureRoot), channels(channels_),
      log_size(size_t((width / kUnit) * (height / kUnit))), contrast(size_t(roots_across * roots_down)),
      rows(kept == KeptSymbols::all ? height : std::min(height, kLastRows)), symbols(size_t(channels * rows * width)),
      extent(size_t(channels) * log_size.size()) {}

void TextureField::begin_roots(int64_t y) {
  if (y < rows) return;
  for (int channel = 0; channel < channels; ++channel)
    std::fill_n(at(channel, {0, y, kTextureRoot}), width << kTextureRoot, int16_t(0));
}

void TextureField::mark(const TextureCell &cell, int log) {
  const int64_t across = cell.side() / kUnit;
  for (int64_t row = 0; row < across; ++row)
    std::fill_n(log_size.begin() + unit(cell.x, cell.y + row * kUnit), across, uint8_t(log));
}

void TextureField::set(const TextureCell &cell, int channel, const int16_t *values, int last) {
  put(cell, channel, values, cell.side());
  state_extent(cell, channel, last);
}

void TextureField::add(const TextureCell &cell, int channel, const int16_t *values, int last) {
  put(cell, channel, values, std::min(cell.side(), last + 1));
  state_extent(cell, channel, last);
}

void TextureField::put(const TextureCell &cell, int channel, const int16_t *values, int rows) {
  const int side = cell.side();
  int16_t *to = at(channel, cell);
  for (int row = 0; row < rows; ++row) std::copy_n(values + row * side, side, to + row * width);
}

void TextureField::state_extent(const TextureCell &cell, int channel, int last) {
  const int side = cell.side(), across = side / kUnit;
  const auto reach = uint8_t(last < 0 ? 0 : 1 + last * 15 / (2 * side - 2));
  for (int64_t row = 0; row < across; ++row)
    std::fill_n(extent.begin() + channel * unit_count() + unit(cell.x, cell.y + row * kUnit), across, reach);
}

void TextureField::clear(const TextureCell &cell) {
  static const CellValues<int16_t> nothing{};
  mark(cell, 0);
  for (int channel = 0; channel < channels; ++channel) set(cell, channel, nothing.data(), -1);
}

void TextureField::find_extents() {
  for (int64_t y = 0; y < height; y += kUnit)
    for (int64_t x = 0; x < width; x += kUnit) {
      const TextureCell cell{x, y, log_size[unit(x, y)]};
      if (!cell.log || (x | y) % cell.side()) continue;
      for (int channel = 0; channel < channels; ++channel)
        state_extent(cell, channel, last_diagonal(at(channel, cell), width, cell.log));
    }
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

int last_diagonal(const int16_t *values, int64_t stride, int log) {
  const int side = 1 << log;
  int last = -1;
  for (int v = 0; v < side; ++v)
    for (int u = side - 1; u >= 0 && u + v > last; --u)
      if (values[v * stride + u]) last = u + v;
  return last;
}

}  // namespace sgi
