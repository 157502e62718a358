// What is known of a texture symbol before it is coded, as the models of its bits (docs/format.md, "Texture").
#pragma once
#include <array>
#include <cstdint>

#include "bitstream/texture_field.hpp"
#include "bitstream/texture_models.hpp"

namespace sgi {

constexpr int kMagnitudeBits = 8;  // a magnitude is coded as up to eight bits "is it larger than j?", then as a rest

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

// The bits of a channel's symbols.
class SymbolContext {
 public:
  // last: diagonal beyond which there are none.
  SymbolContext(const TextureField &field, const TextureCell &cell, int channel, int last);
  // Of the first bit at (u, v); magnitudes: [n, n] of the diagonals before and of this one so far, else 0.
  BitContext at(const int16_t *magnitudes, int u, int v) const;
  // Of a later bit.
  static BitContext later(BitContext first, int bit) {
    for (auto &model : first.model) model += uint32_t(bit);
    for (auto &weights : first.weights) weights += uint32_t(bit);
    return first;
  }

 private:
  void look_around(const TextureField &field, const TextureCell &cell, int channel);
  void look_before(const TextureField &field, const TextureCell &cell, int channel);

  int log_, kind_, last_;
  std::array<uint16_t, 1 << (2 * kTextureRoot)> around_, before_;
};

}  // namespace sgi
