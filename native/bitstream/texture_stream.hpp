// A whole texture layer to bits, and from a payload.
#pragma once
#include <functional>

#include "bitstream/bits.hpp"
#include "bitstream/symbol_coder.hpp"
#include "bitstream/texture_cells.hpp"
#include "bitstream/texture_coding.hpp"

namespace sgi {

// Writes a layer to a RangeEncoder, or to nowhere; what the bits spell (TextureCoding::symbols). width, height: of the
// tile; nodes beyond it are not coded. has_contrast: whether roots with texture have a contrast. The models learn.
// Throws Error (usage) where a reader would not find the same layer.
template <class Bits>
std::vector<int32_t> write_texture(BitModels &models, Bits &bits, const TextureField &field, int64_t width,
                                   int64_t height, bool has_contrast);

// The layer of a tile before anything is read or found.
TextureField empty_field(int64_t width, int64_t height, int channels, KeptSymbols kept = KeptSymbols::all);

// Told after each row of roots how many rows of the tile's pixels have all their cells; may be empty.
using RowsRead = std::function<void(int64_t rows)>;

// Reads a layer into an empty one, and its amplitudes unless `cells` is null. Throws Error (corrupt) where the payload
// does not decode or spells with more than it takes.
void read_texture(BitModels models, SymbolReader &reader, int64_t width, int64_t height, bool has_contrast,
                  TextureField &field, TextureDequantizer *cells, const RowsRead &rows_read);

// Roots that cover a side of so many pixels.
inline int64_t texture_roots(int64_t side) { return (side + (1 << kTextureRoot) - 1) >> kTextureRoot; }

// The root cells of a tile, row by row.
template <class Visit>
void each_root(int64_t width, int64_t height, Visit visit) {
  const int64_t side = 1 << kTextureRoot;
  for (int64_t y = 0; y < height; y += side)
    for (int64_t x = 0; x < width; x += side) visit(TextureCell{x, y, kTextureRoot});
}

}  // namespace sgi
