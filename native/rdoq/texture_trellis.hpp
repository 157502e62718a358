// The symbols of a block of least squared error plus lambda times bits, by the Viterbi algorithm.
#pragma once
#include "bitstream/texture_coding.hpp"
#include "model/texture_quantizer.hpp"

namespace sgi {

// What a channel of a cell would be coded as. last: diagonal, -1 for no symbols; cost in squared steps.
struct Choice {
  CellSymbols values;
  int last;
  float cost;
};

// scaled: amplitudes in steps; the field has the symbols of the first channel. lambda: squared steps per bit. Models do
// not learn within a block.
void choose_block(const BitModels &models, const TextureField &field, const TextureCell &cell, int channel,
                  float lambda, const CellValues<float> &scaled, Choice &choice);

}  // namespace sgi
