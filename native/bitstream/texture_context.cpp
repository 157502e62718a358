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
constexpr int level_of(int sum) {
  if (sum < 8) return sum / 2;
  const int bits = 32 - __builtin_clz(unsigned(sum));
  return 4 + (bits - 4) * 2 + ((sum >> (bits - 2)) & 1);
}

constexpr int kTopLevel = 384;  // the least sum of the last level
static_assert(level_of(kTopLevel) == 15 && level_of(kTopLevel - 1) == 14);

struct Levels {
  uint8_t of[kTopLevel + 1];

  constexpr Levels() : of{} {
    for (int sum = 0; sum <= kTopLevel; ++sum) of[sum] = uint8_t(level_of(sum));
  }
};
constexpr Levels kLevels;

// A table, because no branch can be predicted here.
uint32_t level(int sum) { return kLevels.of[std::min(sum, kTopLevel)]; }

constexpr int kSide = 1 << kTextureRoot, kMaxSum = 1 << 14;

}  // namespace

// Those of symbols of the odd quantiser follow all others, in the order of those of the even one.
BitModels fresh_texture_models() { return {kModels + kExtentModels, kSets + kExtentWeights}; }

BitContext cell_context(const TextureField &field, const TextureCell &cell, CellBit bit) {
  const int64_t middle = cell.side() / 2;
  const auto log_at = [&](int64_t x, int64_t y) {
    return uint32_t(x < 0 || y < 0 ? kLogs - 1 : field.log_size[field.unit(x, y)]);
  };
  const uint32_t left = log_at(cell.x - 1, cell.y + middle), top = log_at(cell.x + middle, cell.y - 1);
  const uint32_t kind = (bit == CellBit::kSplit ? kSizes : 0) + uint32_t(cell.log - kTextureLeast);
  const uint32_t first = kCellModels + kind * (kLogs * kLogs + 1);
  return {
      {first + left * kLogs + top, first + kLogs * kLogs}, {kCellWeights + kind, kCellWeights + 2 * kSizes + kind}, 2};
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
    : log_(cell.log), kind_(int(kind_of(channel))), last_(last), rows_(std::min(cell.side(), last + 1)) {
  look_around(field, cell, channel);
  if (channel > 0) look_before(field, cell, channel);
}

// Adds `times` eight times the magnitudes of a cell of this size that lies in the field, smoothed; beyond the lowest
// frequencies they are what they are there with `edge`, else zero.
void SymbolContext::add_crosses(const TextureField &field, int channel, const TextureCell &cell, int times, bool edge,
                                Sums &sums) const {
  constexpr int kStride = kSide + 2;
  const int side = 1 << log_;
  std::array<int16_t, kStride * kStride> padded;
  const auto row_of = [&](int v) { return padded.data() + (v + 1) * kStride + 1; };
  const int16_t *symbols = field.at(channel, cell);
  const int filled = std::min(side, rows_ + 1);
  for (int v = 0; v < filled; ++v) {
    int16_t *row = row_of(v);
    for (int u = 0; u < side; ++u) row[u] = int16_t(std::abs(symbols[v * field.width + u]));
    row[-1] = edge ? row[0] : int16_t(0);
    row[side] = 0;
  }
  if (edge)
    std::copy_n(row_of(0), side, row_of(-1));
  else
    std::fill_n(row_of(-1), side, int16_t(0));
  if (filled == rows_) std::fill_n(row_of(rows_), side, int16_t(0));
  for (int v = 0; v < rows_; ++v) {
    const int16_t *above = row_of(v - 1), *row = row_of(v), *below = row_of(v + 1);
    int32_t *to = &sums[v << log_];
    for (int u = 0; u < side; ++u) to[u] += times * (4 * row[u] + row[u - 1] + row[u + 1] + above[u] + below[u]);
  }
}

// Adds `times` eight times the magnitudes that the cell at pixel (x, y) has at the frequencies of this one.
void SymbolContext::add_magnitudes(const TextureField &field, int channel, int64_t x, int64_t y, int times,
                                   Sums &sums) const {
  const int log = field.log_size[field.unit(x, y)];
  if (!log) return;
  const TextureCell cell{x & ~(int64_t(1 << log) - 1), y & ~(int64_t(1 << log) - 1), log};
  if (log == log_) return add_crosses(field, channel, cell, times, true, sums);
  const int16_t *symbols = field.at(channel, cell);
  const int side = 1 << log_;
  if (log < log_) {
    const int shift = log_ - log;
    for (int v = 0; v < rows_; ++v)
      for (int u = 0; u < side; ++u)
        sums[v << log_ | u] += times * 8 * std::abs(symbols[(v >> shift) * field.width + (u >> shift)]);
    return;
  }
  const int shift = log - log_;
  for (int v = 0; v < rows_; ++v) {
    std::array<int32_t, kSide> lines{};
    for (int row = v << shift; row < (v + 1) << shift; ++row)
      for (int u = 0; u < 1 << log; ++u) lines[u] += std::abs(symbols[row * field.width + u]);
    for (int u = 0; u < side; ++u) {
      int sum = 0;
      for (int i = u << shift; i < (u + 1) << shift; ++i) sum += lines[i];
      sums[v << log_ | u] += times * (8 * sum >> 2 * shift);
    }
  }
}

void SymbolContext::look_around(const TextureField &field, const TextureCell &cell, int channel) {
  const int64_t middle = cell.side() / 2;
  const bool left = cell.x > 0, top = cell.y > 0;
  std::fill_n(around_.begin(), rows_ << log_, 0);
  if (left) add_magnitudes(field, channel, cell.x - 1, cell.y + middle, top ? 1 : 2, around_);
  if (top) add_magnitudes(field, channel, cell.x + middle, cell.y - 1, left ? 1 : 2, around_);
  for (int i = 0; i < rows_ << log_; ++i) around_[i] = std::min(around_[i], kMaxSum);
}

void SymbolContext::look_before(const TextureField &field, const TextureCell &cell, int channel) {
  std::fill_n(before_.begin(), rows_ << log_, 0);
  add_crosses(field, 0, cell, 1, false, before_);
  if (channel > 1) add_crosses(field, channel - 1, cell, 1, false, before_);
  for (int i = 0; i < rows_ << log_; ++i) before_[i] = std::min(before_[i], kMaxSum);
}

SymbolPlace SymbolContext::place(int u, int v) const {
  const int index = v << log_ | u;
  const auto kind = uint32_t(kind_), zone = uint32_t(std::min(15, (u + v) >> (log_ - kTextureLeast)));
  const int half = log_ == kTextureRoot, across = std::min(log_, 4);
  const uint32_t place = (log_ == 3 ? 0 : log_ == 4 ? 64 : 320) + uint32_t((v >> half) << across | u >> half);
  const uint32_t sized = kind * kSizes + uint32_t(log_ - kTextureLeast);
  SymbolPlace found;
  found.has_before_ = kind_ > 0;
  found.outside_ = 2 * (around_[index] + (kind_ ? before_[index] : 0));
  found.far_ = uint32_t(bits_of(last_ - u - v));
  found.models_ = {kPlaceModels + (kind * kPlaces + place) * kMagnitudeBits,
                   kAroundModels + (kind * kLevelsOf + level(around_[index])) * kLevelsOf * kMagnitudeBits,
                   kRestModels + (kind * kZones + zone) * kZones * kMagnitudeBits,
                   kTotalModels + (sized * kLevelsOf * kZones + zone) * kMagnitudeBits};
  found.weights_ = {kSizeWeights + sized * kMagnitudeBits, kLevelWeights + kind * kLevelsOf * kMagnitudeBits};
  return found;
}

BitContext SymbolPlace::at(const NearMagnitudes &near, QuantizerState state) const {
  const int total = 3 * near.inside + outside_;
  const uint32_t sum = level(has_before_ ? total * 3 / 4 : total);
  const uint32_t rest = std::min(15u, far_ + 4 * uint32_t(std::min(3, near.next)));
  const uint32_t models = state.odd() ? kModels : 0, weights = state.odd() ? kSets : 0;
  return {{models + models_[0], models + models_[1] + level(near.inside) * kMagnitudeBits,
           models + models_[2] + rest * kMagnitudeBits, models + models_[3] + sum * kZones * kMagnitudeBits},
          {weights + weights_[0], weights + weights_[1] + sum * kMagnitudeBits},
          4};
}

BitContext SymbolContext::at(const NearMagnitudes &near, int u, int v, QuantizerState state) const {
  return place(u, v).at(near, state);
}

}  // namespace sgi
