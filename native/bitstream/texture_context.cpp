#include "bitstream/texture_context.hpp"

#include <algorithm>
#include <cstdlib>

namespace sgi {

namespace {

constexpr uint32_t kKinds = 3;  // of channels: the first, the second, all others
constexpr uint32_t kLevelsOf = 16, kZones = 16, kNodes = 64, kExtents = 8;
constexpr uint32_t kPlaces = 64 + 256 + 256;  // of frequencies of all sizes; those of 32 in pairs
constexpr uint32_t kSizes = kTextureSizes;

// Where the models of each context begin.
constexpr uint32_t kPlaceModels = 0;
constexpr uint32_t kAroundModels = kPlaceModels + kKinds * kPlaces * kMagnitudeBits;
constexpr uint32_t kRestModels = kAroundModels + kKinds * kLevelsOf * kLevelsOf * kMagnitudeBits;
constexpr uint32_t kTotalModels = kRestModels + kKinds * kZones * kZones * kMagnitudeBits;
constexpr uint32_t kExtentModels = kTotalModels + kKinds * kSizes * kLevelsOf * kZones * kMagnitudeBits;
constexpr uint32_t kCellModels = kExtentModels + kKinds * kSizes * (2 * kExtents + 1) * kNodes;
constexpr uint32_t kLogs = kTextureRoot + 2;  // of what lies around a cell: none, of a size, or nothing known
constexpr uint32_t kContrastModels = kCellModels + 2 * kSizes * (kLogs * kLogs + 1);
constexpr uint32_t kModels = kContrastModels + kContrastLimit * 2 + 2;

constexpr uint32_t kSizeWeights = 0;
constexpr uint32_t kLevelWeights = kSizeWeights + kKinds * kSizes * kMagnitudeBits;
constexpr uint32_t kExtentWeights = kLevelWeights + kKinds * kLevelsOf * kMagnitudeBits;
constexpr uint32_t kCellWeights = kExtentWeights + 2 * kKinds * kSizes;
constexpr uint32_t kContrastWeights = kCellWeights + 4 * kSizes;
constexpr uint32_t kSets = kContrastWeights + 2;

uint32_t kind_of(int channel) { return uint32_t(std::min<int>(channel, kKinds - 1)); }

int bits_of(int value) { return value > 0 ? 32 - __builtin_clz(unsigned(value)) : 0; }

// Sixteen levels of a weighted sum of magnitudes: two per octave, finer near zero.
uint32_t level(int sum) {
  if (sum < 8) return uint32_t(sum) / 2;
  const int bits = bits_of(sum);
  return uint32_t(std::min(15, 4 + (bits - 4) * 2 + ((sum >> (bits - 2)) & 1)));
}

int cross(const int16_t *symbol, int64_t stride, int u, int v, int side, bool edge) {
  int sum = 4 * std::abs(*symbol);
  sum += u > 0 ? std::abs(symbol[-1]) : edge ? std::abs(*symbol) : 0;
  sum += v > 0 ? std::abs(symbol[-stride]) : edge ? std::abs(*symbol) : 0;
  if (u + 1 < side) sum += std::abs(symbol[1]);
  if (v + 1 < side) sum += std::abs(symbol[stride]);
  return sum;
}

// Eight times the magnitude that the cell at pixel (x, y) has at frequency (u, v) of one of `side` pixels; of a cell of
// the same size smoothed.
int magnitude(const TextureField &field, int channel, int64_t x, int64_t y, int u, int v, int side) {
  const int log = field.log_size[field.unit(x, y)];
  if (!log) return 0;
  const int other = 1 << log;
  const TextureCell cell{x & ~int64_t(other - 1), y & ~int64_t(other - 1), log};
  const int16_t *symbols = field.at(channel, cell);
  const int64_t stride = field.width;
  if (other == side) return cross(symbols + v * stride + u, stride, u, v, side, true);
  if (other < side) {
    const int ratio = side / other;
    return 8 * std::abs(symbols[(v / ratio) * stride + u / ratio]);
  }
  const int ratio = other / side;
  int sum = 0;
  for (int j = 0; j < ratio; ++j)
    for (int i = 0; i < ratio; ++i) sum += std::abs(symbols[(v * ratio + j) * stride + u * ratio + i]);
  return 8 * sum / (ratio * ratio);
}

uint16_t capped(int sum) { return uint16_t(std::min(sum, 1 << 14)); }

}  // namespace

BitModels fresh_texture_models() { return {kModels, kSets}; }

BitContext cell_context(const TextureField &field, const TextureCell &cell, CellBit bit) {
  const int64_t middle = cell.side() / 2;
  const auto log_at = [&](int64_t x, int64_t y) {
    return uint32_t(x < 0 || y < 0 ? kLogs - 1 : field.log_size[field.unit(x, y)]);
  };
  const uint32_t left = log_at(cell.x - 1, cell.y + middle), top = log_at(cell.x + middle, cell.y - 1);
  const uint32_t kind = (bit == CellBit::kSplit ? kSizes : 0) + uint32_t(cell.log - kTextureLeast);
  const uint32_t first = kCellModels + kind * (kLogs * kLogs + 1);
  return {{first + left * kLogs + top, first + kLogs * kLogs}, {kCellWeights + kind, kCellWeights + 2 * kSizes + kind}, 2};
}

BitContext contrast_context(int bit) {
  return {{kContrastModels + uint32_t(bit)}, {kContrastWeights, kContrastWeights + 1}, 1};
}

ExtentContext::ExtentContext(const TextureField &field, const TextureCell &cell, int channel) {
  const int64_t middle = cell.side() / 2;
  const uint8_t *extent = field.extent.data() + channel * field.unit_count();
  int left = cell.x > 0 ? extent[field.unit(cell.x - 1, cell.y + middle)] : -1;
  int top = cell.y > 0 ? extent[field.unit(cell.x + middle, cell.y - 1)] : left;
  if (left < 0) left = top;
  left = std::max(left, 0), top = std::max(top, 0);
  around_ = uint32_t(std::min(7, (left + top + 3) / 4));
  const int before = channel ? (extent - field.unit_count())[field.unit(cell.x, cell.y)] : 0;
  beside_ = uint32_t(std::min(7, channel ? (before + 1) / 2 : std::abs(left - top) / 2));
  kind_ = kind_of(channel) * kSizes + uint32_t(cell.log - kTextureLeast);
}

BitContext ExtentContext::at(int node) const {
  const uint32_t first = kExtentModels + kind_ * (2 * kExtents + 1) * kNodes + uint32_t(node);
  return {{first + around_ * kNodes, first + (kExtents + beside_) * kNodes, first + 2 * kExtents * kNodes},
          {kExtentWeights + kind_, kExtentWeights + kKinds * kSizes + kind_},
          3};
}

SymbolContext::SymbolContext(const TextureField &field, const TextureCell &cell, int channel, int last)
    : log_(cell.log), kind_(int(kind_of(channel))), last_(last) {
  look_around(field, cell, channel);
  look_before(field, cell, channel);
}

void SymbolContext::look_around(const TextureField &field, const TextureCell &cell, int channel) {
  const int side = cell.side();
  const int64_t middle = side / 2;
  for (int v = 0; v < side && v <= last_; ++v)
    for (int u = 0; u < side && u + v <= last_; ++u) {
      int left = cell.x > 0 ? magnitude(field, channel, cell.x - 1, cell.y + middle, u, v, side) : -1;
      const int top = cell.y > 0 ? magnitude(field, channel, cell.x + middle, cell.y - 1, u, v, side) : std::max(left, 0);
      if (left < 0) left = top;
      around_[v * side + u] = capped(left + top);
    }
}

void SymbolContext::look_before(const TextureField &field, const TextureCell &cell, int channel) {
  const int side = cell.side();
  for (int v = 0; v < side && v <= last_; ++v)
    for (int u = 0; u < side && u + v <= last_; ++u) {
      int sum = 0;
      if (channel > 0) sum += cross(field.at(0, cell) + v * field.width + u, field.width, u, v, side, false);
      if (channel > 1) sum += cross(field.at(channel - 1, cell) + v * field.width + u, field.width, u, v, side, false);
      before_[v * side + u] = capped(sum);
    }
}

BitContext SymbolContext::at(const int16_t *magnitudes, int u, int v) const {
  const int side = 1 << log_, index = v * side + u;
  const auto near = [&](int du, int dv) {
    const int x = u + du, y = v + dv;
    return x < 0 || y < 0 || x >= side || y >= side ? 0 : int(magnitudes[y * side + x]);
  };
  const int next = near(-1, 0) + near(0, -1);
  const int inside = 4 * next + 2 * (near(-1, -1) + near(-2, 0) + near(0, -2)) +
                     2 * (near(-1, 1) + near(1, -2) + near(-2, 1));
  int total = 3 * inside + 2 * around_[index];
  if (kind_) total = (total + 2 * before_[index]) * 3 / 4;
  const auto kind = uint32_t(kind_), size = uint32_t(log_ - kTextureLeast), sum = level(total);
  const auto zone = uint32_t(std::min(15, (u + v) * 8 / side));
  const auto rest = uint32_t(std::min(15, bits_of(last_ - u - v) + 4 * std::min(3, next)));
  const uint32_t place = log_ == 3 ? index : log_ == 4 ? 64 + index : 320 + (v >> 1) * 16 + (u >> 1);
  const uint32_t sized = kind * kSizes + size;
  return {{kPlaceModels + (kind * kPlaces + place) * kMagnitudeBits,
           kAroundModels + ((kind * kLevelsOf + level(around_[index])) * kLevelsOf + level(inside)) * kMagnitudeBits,
           kRestModels + ((kind * kZones + zone) * kZones + rest) * kMagnitudeBits,
           kTotalModels + ((sized * kLevelsOf + sum) * kZones + zone) * kMagnitudeBits},
          {kSizeWeights + sized * kMagnitudeBits, kLevelWeights + (kind * kLevelsOf + sum) * kMagnitudeBits},
          4};
}

}  // namespace sgi
