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

// What a symbol's neighbours of lower frequency are, as weighted sums of magnitudes.
struct NearMagnitudes {
  int next, inside;
};

// The magnitudes of the three diagonals of a block around the symbol that is coded, by u; those not coded yet are 0.
class KnownMagnitudes {
 public:
  void clear() { diagonals_ = {}; }
  // Goes on to the next diagonal.
  void advance() {
    here_ = here_ == 2 ? 0 : here_ + 1;
    diagonals_[here_].fill(0);
  }
  void set(int u, int magnitude) { diagonals_[here_][u + 2] = int16_t(magnitude); }
  NearMagnitudes near(int u) const {
    const int16_t *here = &diagonals_[here_][u + 2], *last = &diagonals_[here_ ? here_ - 1 : 2][u + 2];
    const int16_t *before = &diagonals_[here_ == 2 ? 0 : here_ + 1][u + 2];
    const int next = last[-1] + last[0];
    return {next, 4 * next + 2 * (before[-1] + before[-2] + before[0] + here[-1] + last[1] + last[-2])};
  }

 private:
  std::array<std::array<int16_t, (1 << kTextureRoot) + 4>, 3> diagonals_{};
  int here_ = 0;  // the diagonal of the symbol; the ones before it go round
};

// The first bit of a symbol, for any symbols near it in its block.
class SymbolPlace {
 public:
  // near: of the diagonals before and of this one so far.
  BitContext at(const NearMagnitudes &near, QuantizerState state) const;

 private:
  friend class SymbolContext;

  bool has_before_;
  int outside_;                             // what its neighbours outside the block weigh
  uint32_t far_;                            // how many binary digits its distance from the last diagonal has
  std::array<uint32_t, kMaxMixed> models_;  // of no symbols near it
  std::array<uint32_t, 2> weights_;
};

// The bits of a channel's symbols.
class SymbolContext {
 public:
  // last: diagonal beyond which there are none.
  SymbolContext(const TextureField &field, const TextureCell &cell, int channel, int last);
  SymbolPlace place(int u, int v) const;
  // Of the first bit at (u, v), as in `SymbolPlace`.
  BitContext at(const NearMagnitudes &near, int u, int v, QuantizerState state) const;
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
