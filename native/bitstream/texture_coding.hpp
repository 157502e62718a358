// The order in which a texture layer is coded, for writers and readers alike (docs/format.md, "Texture").
#pragma once
#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "bitstream/bits.hpp"
#include "bitstream/texture_context.hpp"

namespace sgi {

using CellSymbols = CellValues<int16_t>;

// What a node of the quadtree is; the smallest cells are never split.
enum Node { kNoTexture, kTextureLeaf, kSplitNode };

// Codes a layer part by part. `Bits` records bits that it is given, or reads bits whatever it is given. `field` holds
// what has been coded so far; who calls puts the decoded parts there.
template <class Bits>
class TextureCoding {
 public:
  TextureCoding(BitModels &models, TextureField &field, Bits &bits) : models_(models), field_(field), bits_(bits) {}

  // Everything coded so far but how it is spelled: nodes, contrasts less the ones before, extents and symbols.
  std::vector<int32_t> symbols;
  bool sound() const { return sound_; }

  int node(const TextureCell &cell, int what) {
    int coded = bit(cell_context(field_, cell, CellBit::kTextured), what != kNoTexture);
    if (coded && cell.log > kTextureLeast)
      coded += bit(cell_context(field_, cell, CellBit::kSplit), what == kSplitNode);
    symbols.push_back(coded);
    return coded;
  }

  // The contrast of a root; the last one is what the next is compared with.
  int contrast(int value) {
    const int difference = value - last_contrast_;
    int coded = bit(contrast_context(0), difference != 0);
    if (coded) {
      const int sign = bit(contrast_context(1), difference < 0);
      while (sound_ && coded < 2 * kContrastLimit && bit(contrast_context(1 + coded), std::abs(difference) > coded))
        ++coded;
      coded = sign ? -coded : coded;
    }
    symbols.push_back(coded);
    last_contrast_ += coded;
    sound_ = sound_ && std::abs(last_contrast_) <= kContrastLimit;
    return last_contrast_;
  }

  // A channel's symbols of a cell; the last diagonal with any, -1 for none. Those beyond it stay as they are. Not sound
  // where there is none on the last diagonal.
  int block(const TextureCell &cell, int channel, int last, CellSymbols &values) {
    last = extent(ExtentContext(field_, cell, channel), cell.log, last + 1) - 1;
    if (last < 0 || !sound_) return -1;
    const SymbolContext context(field_, cell, channel, last);
    known_.clear();
    QuantizerState state;
    int highest = -1, diagonal = 0;
    for (const Frequency &at : texture_scan(cell.log)) {
      if (at.diagonal() > last || !sound_) break;
      if (at.diagonal() > diagonal) known_.advance(), ++diagonal;
      int16_t &value = values[at.index];
      value = int16_t(symbol(context.at(known_.near(at.u), at, state), value));
      state = state.after(value);
      if (!value) continue;
      known_.set(at.u, std::abs(value));
      highest = at.diagonal();
    }
    sound_ = sound_ && highest == last;
    return last;
  }

 private:
  int bit(const BitContext &context, int value) {
    const int32_t one = models_.predict(context);
    if (sound_) bits_.code(one, value);
    models_.update(context, one, value);
    return value;
  }

  int even(int value) {
    if (sound_) bits_.code(kEvenOdds, value);
    return value;
  }

  int extent(const ExtentContext &context, int log, int value) {
    int node = 1;
    for (int place = log; place >= 0; --place) node = 2 * node + bit(context.at(node), value >> place & 1);
    symbols.push_back(node - (2 << log));
    return symbols.back();
  }

  int symbol(BitContext context, int value) {
    const int magnitude = std::abs(value);
    int coded = 0;
    while (coded < kMagnitudeBits && bit(context, magnitude > coded)) {
      context = SymbolContext::later(context, 1);
      ++coded;
    }
    if (coded == kMagnitudeBits) coded += rest(magnitude - coded);
    if (coded && even(value < 0)) coded = -coded;
    symbols.push_back(coded);
    return coded;
  }

  // Exp-Golomb: of value + 1 the number of binary digits in unary, then all but the first.
  int rest(int value) {
    int digits = 0;
    while (even((value + 1) >> (digits + 1) != 0)) {
      if (!sound_ || ++digits > kRestDigits) {
        sound_ = false;
        return 0;
      }
    }
    int coded = 1;
    for (int place = digits - 1; place >= 0; --place) coded = 2 * coded + even((value + 1) >> place & 1);
    return coded - 1;
  }

  BitModels &models_;
  TextureField &field_;
  Bits &bits_;
  bool sound_ = true;
  int last_contrast_ = 0;
  KnownMagnitudes known_;
};

}  // namespace sgi
