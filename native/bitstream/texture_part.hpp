// The texture part of a tile: step sizes, then the layer under adaptive models (docs/format.md, "Texture").
#pragma once
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "bitstream/limits.hpp"
#include "bitstream/symbol_coder.hpp"
#include "bitstream/texture_cells.hpp"
#include "bitstream/texture_models.hpp"
#include "model/texture_colours.hpp"

namespace sgi {

// The steps and the grid as indices of the stream.
struct TextureIndices {
  int step = 0;
  std::vector<int32_t> ratios;  // [C - 1]
  std::array<int, 2> slopes{};
  std::array<int, 3> excess{};
  bool has_contrast = false;
  TextureGrid grid;
  TextureColours colours;

  TextureSteps steps() const;
  std::array<float, 3> added() const;  // to magnitudes 1, 2 and larger ones
};

struct CodedTexture {
  TextureIndices indices;
  TextureField field;
};

// The state of the adaptive models with which a layer begins.
const BitModels &shipped_texture_models();

// Told of cells as they are read: those of the tile's first `rows` rows are all there, and stay where they are.
using TextureRows = std::function<void(int64_t rows, const Texture &cells)>;

// What a tile says of its layer before the cells, none where it has none. Throws Error: limit for a tile that is too
// large or takes more memory, unsupported for models of another number, corrupt.
template <class Coder>
void code_texture_indices(Coder &coder, int64_t width, int64_t height, int channels,
                          std::optional<TextureIndices> &indices, int64_t memory = kAnyMemory);
// Then the layer, as symbols. Throws Error (corrupt).
CodedTexture read_texture_layer(SymbolReader &reader, TextureIndices indices, int64_t width, int64_t height,
                                int channels);
// Or as cells with amplitudes, whose symbols are not kept. Throws Error (corrupt).
void read_texture_cells(SymbolReader &reader, const TextureIndices &indices, int64_t width, int64_t height,
                        int channels, TextureCells &cells, const TextureRows &rows_read);

// All of the part. Throws Error: limit for a tile that is too large, usage where a reader would not find the same
// layer.
void write_texture_part(SymbolWriter &writer, const std::optional<CodedTexture> &texture, int64_t width, int64_t height,
                        int channels);

}  // namespace sgi
