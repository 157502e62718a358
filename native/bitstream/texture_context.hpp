// What is known of a texture symbol before it is coded, as the models of its bits (docs/format.md, "Texture").
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>

#include "bitstream/texture_field.hpp"
#include "bitstream/texture_models.hpp"

namespace sgi {

constexpr int kMagnitudeBits = 8;  // a magnitude is coded as up to eight bits "is it larger than j?", then as a rest
constexpr int kRestDigits = 13;    // of the rest + 1, behind the first
static_assert(kTextureMost == kMagnitudeBits + (2 << kRestDigits) - 2);

// Models and weights of all bits of texture, none of them seen yet.
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

// The magnitudes of a cell's symbols as far as they are known, in zeros.
class KnownMagnitudes {
 public:
  void clear(int side) { std::fill_n(values_.begin(), (side + 3) * kStride, int16_t(0)); }
  void set(int u, int v, int magnitude) { values_[(v + 2) * kStride + u + 2] = int16_t(magnitude); }
  const int16_t *at(int u, int v) const { return &values_[(v + 2) * kStride + u + 2]; }

  static constexpr int kStride = (1 << kTextureRoot) + 4;

 private:
  std::array<int16_t, ((1 << kTextureRoot) + 3) * kStride> values_;
};

// The bits of a channel's symbols.
class SymbolContext {
 public:
  // last: diagonal beyond which there are none.
  SymbolContext(const TextureField &field, const TextureCell &cell, int channel, int last);
  // Of the first bit at (u, v); known: magnitudes of the diagonals before and of this one so far.
  BitContext at(const KnownMagnitudes &known, int u, int v) const;
  // Of a later bit.
  static BitContext later(BitContext first, int bit) {
    for (auto &model : first.model) model += uint32_t(bit);
    for (auto &weights : first.weights) weights += uint32_t(bit);
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

}  // namespace sgi
