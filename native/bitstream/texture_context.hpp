// What is known of a texture symbol before it is coded, as the models of its bits (docs/format.md, "Texture").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "bitstream/texture_field.hpp"
#include "bitstream/texture_models.hpp"
#include "model/texture_quantizer.hpp"

namespace sgi {

constexpr int kMagnitudeBits = 8;  // a magnitude is coded as up to eight bits "is it larger than j?", then as a rest
constexpr int kRestDigits = 13;    // of the rest + 1, behind the first
static_assert(kTextureMost == kMagnitudeBits + (2 << kRestDigits) - 2);

// How the numbers of contexts are made.
namespace texture_models {

constexpr uint32_t kKinds = 3;  // of channels: the first, the second, all others
constexpr uint32_t kLevelsOf = 16, kZones = 16, kNodes = 64, kExtents = 8;
constexpr uint32_t kAheads = 8, kNexts = 4;   // binary digits of a distance to the last diagonal; near magnitudes
constexpr uint32_t kPlaces = 64 + 256 + 256;  // of frequencies of all sizes; those of 32 in pairs
constexpr uint32_t kSizes = kTextureSizes;

constexpr int kSlow = 6, kFast = 4;  // rates of magnitudes, of which there are many, and of all other bits

// Where the contexts of each kind begin.
constexpr uint32_t kPlaceContexts = 0;
constexpr uint32_t kAroundContexts = kPlaceContexts + kKinds * kPlaces * kMagnitudeBits;
constexpr uint32_t kRestContexts = kAroundContexts + kKinds * kLevelsOf * kLevelsOf * kMagnitudeBits;
constexpr uint32_t kTotalContexts = kRestContexts + kKinds * kZones * kNexts * kAheads * kMagnitudeBits;
constexpr uint32_t kExtentContexts = kTotalContexts + kKinds * kSizes * kLevelsOf * kZones * kMagnitudeBits;
constexpr uint32_t kCellContexts = kExtentContexts + kKinds * kSizes * (2 * kExtents + 1) * kNodes;
constexpr uint32_t kLogs = kTextureRoot + 2;  // of what lies around a cell: none, of a size, or nothing known
constexpr uint32_t kContrastContexts = kCellContexts + 2 * kSizes * (kLogs * kLogs + 1);
constexpr uint32_t kContexts = kContrastContexts + kContrastLimit * 2 + 2;

inline int bits_of(int value) { return value > 0 ? 32 - __builtin_clz(unsigned(value)) : 0; }

// Sixteen levels of a weighted sum of magnitudes: two per octave, finer near zero.
constexpr int level_of(int sum) {
  if (sum < 8) return sum / 2;
  const int bits = 32 - __builtin_clz(unsigned(sum));
  return 4 + (bits - 4) * 2 + ((sum >> (bits - 2)) & 1);
}

constexpr int kTopLevel = 384;  // the least sum of the last level
static_assert(level_of(kTopLevel) == 15 && level_of(kTopLevel - 1) == 14);

struct LevelTable {
  uint8_t of[kTopLevel + 1];

  constexpr LevelTable() : of{} {
    for (int sum = 0; sum <= kTopLevel; ++sum) of[sum] = uint8_t(level_of(sum));
  }
};
inline constexpr LevelTable kLevelTable;

// A table, because no branch can be predicted here.
inline uint32_t level(int sum) { return kLevelTable.of[std::min(sum, kTopLevel)]; }

}  // namespace texture_models

// Models of all bits of texture, which say nothing yet.
BitModels fresh_texture_models();

// The bit "has texture", and "is split", of a quadtree node.
enum class CellBit { kTextured, kSplit };
BitContext cell_context(const TextureField &field, const TextureCell &cell, CellBit bit);

// A bit of how much a root's contrast differs from the last one's: 0 "at all", 1 the sign, 2 ... "more?".
BitContext contrast_context(int bit);

// The bits of a channel's extent: 0 for no symbols, else its last diagonal + 1; log2(side) + 1 bits, a binary tree.
class ExtentContext {
 public:
  ExtentContext(const TextureField &field, const TextureCell &cell, int channel);
  // node: 1 at first, then twice the node before, plus the bit.
  BitContext at(int node) const;

 private:
  uint32_t kind_, around_, beside_;
};

// What a symbol's neighbours of lower frequency are, as weighted sums of magnitudes.
struct NearMagnitudes {
  int next, inside;
};

// The magnitudes of the three diagonals of a block around the symbol that is coded, by u; those not coded yet are 0.
class KnownMagnitudes {
 public:
  void clear() { magnitudes_ = {}; }
  // Goes on to the next diagonal, in the place of the oldest one.
  void advance() {
    const int oldest = before_;
    before_ = last_, last_ = here_, here_ = oldest;
    std::fill_n(magnitudes_.begin() + here_, kStride, int16_t(0));
  }
  void set(int u, int magnitude) { magnitudes_[here_ + u + 2] = int16_t(magnitude); }
  NearMagnitudes near(int u) const {
    const int16_t *first = &magnitudes_[u + 2], *here = first + here_, *last = first + last_, *before = first + before_;
    const int next = last[-1] + last[0];
    return {next, 4 * next + 2 * (before[-1] + before[-2] + before[0] + here[-1] + last[1] + last[-2])};
  }

 private:
  static constexpr int kStride = (1 << kTextureRoot) + 4;
  std::array<int16_t, 3 * kStride> magnitudes_{};
  int here_ = 0, last_ = kStride, before_ = 2 * kStride;  // where the symbol's diagonal is, and the ones before it
};

// The first bit of a symbol, for any symbols near it in its block.
class SymbolPlace {
 public:
  // near: of the diagonals before and of this one so far.
  BitContext at(const NearMagnitudes &near, QuantizerState state) const;

 private:
  friend class SymbolContext;

  bool has_before_;
  int outside_;                                  // what its neighbours outside the block weigh
  uint32_t far_;                                 // how many binary digits its distance from the last diagonal has
  std::array<uint32_t, kMaxContexts> contexts_;  // of no symbols near it
};

// The bits of a channel's symbols.
class SymbolContext {
 public:
  // last: diagonal beyond which there are none.
  SymbolContext(const TextureField &field, const TextureCell &cell, int channel, int last);
  SymbolPlace place(const Frequency &at) const;
  // Of the first bit of a frequency, as in `SymbolPlace`.
  BitContext at(const NearMagnitudes &near, const Frequency &at, QuantizerState state) const;
  // Of a later bit.
  static BitContext later(BitContext first, int bit) {
    for (auto &number : first.number) number += uint32_t(bit);
    return first;
  }

 private:
  using Sums = CellValues<int32_t>;  // by frequency

  void look_around(const TextureField &field, const TextureCell &cell, int channel);
  void look_before(const TextureField &field, const TextureCell &cell, int channel);
  void add_magnitudes(const TextureField &field, int channel, int64_t x, int64_t y, int times, Sums &sums) const;
  void add_crosses(const TextureField &field, int channel, const TextureCell &cell, int times, bool edge,
                   Sums &sums) const;

  int log_, kind_, last_, rows_;
  Sums around_, before_;
};

inline SymbolPlace SymbolContext::place(const Frequency &at) const {
  using namespace texture_models;
  const int index = at.index, half = log_ == kTextureRoot, across = std::min(log_, 4);
  const auto zone_of = [&](int diagonal) { return uint32_t(std::min(15, diagonal >> (log_ - kTextureLeast))); };
  const auto kind = uint32_t(kind_), zone = zone_of(at.diagonal());
  const uint32_t place = (log_ == 3 ? 0 : log_ == 4 ? 64 : 320) + uint32_t((at.v >> half) << across | at.u >> half);
  const uint32_t sized = kind * kSizes + uint32_t(log_ - kTextureLeast);
  SymbolPlace found;
  found.has_before_ = kind_ > 0;
  found.outside_ = 2 * (around_[index] + (kind_ ? before_[index] : 0));
  found.far_ = uint32_t(bits_of(last_ - at.diagonal()));
  found.contexts_ = {kPlaceContexts + (kind * kPlaces + place) * kMagnitudeBits,
                     kAroundContexts + (kind * kLevelsOf + level(around_[index])) * kLevelsOf * kMagnitudeBits,
                     kRestContexts + (kind * kZones + zone_of(last_)) * kNexts * kAheads * kMagnitudeBits,
                     kTotalContexts + (sized * kLevelsOf * kZones + zone) * kMagnitudeBits};
  return found;
}

inline BitContext SymbolPlace::at(const NearMagnitudes &near, QuantizerState state) const {
  using namespace texture_models;
  const int total = 3 * near.inside + outside_;
  const uint32_t sum = level(has_before_ ? total * 3 / 4 : total);
  const uint32_t rest = kAheads * std::min(kNexts - 1, uint32_t(near.next)) + far_;
  const uint32_t first = state.odd() ? kContexts : 0;
  return {{first + contexts_[0], first + contexts_[1] + level(near.inside) * kMagnitudeBits,
           first + contexts_[2] + rest * kMagnitudeBits, first + contexts_[3] + sum * kZones * kMagnitudeBits},
          4,
          kSlow};
}

inline BitContext SymbolContext::at(const NearMagnitudes &near, const Frequency &at, QuantizerState state) const {
  return place(at).at(near, state);
}

}  // namespace sgi
