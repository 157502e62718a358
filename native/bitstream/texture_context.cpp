#include "bitstream/texture_context.hpp"

#include <algorithm>
#include <cstdlib>

namespace sgi {

using namespace texture_models;

namespace {

uint32_t kind_of(int channel) { return uint32_t(std::min<int>(channel, kKinds - 1)); }

constexpr int kSide = 1 << kTextureRoot, kMaxSum = 1 << 14;

}  // namespace

// Those of symbols of the odd quantiser follow all others, in the order of those of the even one.
BitModels fresh_texture_models() { return BitModels(kContexts + kExtentContexts); }

BitContext cell_context(const TextureField &field, const TextureCell &cell, CellBit bit) {
  const int64_t middle = cell.side() / 2;
  const auto log_at = [&](int64_t x, int64_t y) {
    return uint32_t(x < 0 || y < 0 ? kLogs - 1 : field.log_size[field.unit(x, y)]);
  };
  const uint32_t left = log_at(cell.x - 1, cell.y + middle), top = log_at(cell.x + middle, cell.y - 1);
  const uint32_t kind = (bit == CellBit::kSplit ? kSizes : 0) + uint32_t(cell.log - kTextureLeast);
  const uint32_t first = kCellContexts + kind * (kLogs * kLogs + 1);
  return {{first + left * kLogs + top, first + kLogs * kLogs}, 2, kFast};
}

BitContext contrast_context(int bit) { return {{kContrastContexts + uint32_t(bit)}, 1, kFast}; }

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
  const uint32_t first = kExtentContexts + kind_ * (2 * kExtents + 1) * kNodes + uint32_t(node);
  return {{first + around_ * kNodes, first + (kExtents + beside_) * kNodes, first + 2 * kExtents * kNodes}, 3, kFast};
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

}  // namespace sgi
