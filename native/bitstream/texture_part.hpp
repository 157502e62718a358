// The texture part of a tile: step sizes, then the layer under adaptive models (docs/format.md, "Texture").
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "bitstream/limits.hpp"
#include "bitstream/symbol_reader.hpp"
#include "bitstream/texture_cells.hpp"
#include "bitstream/texture_models.hpp"
#include "model/texture_colours.hpp"

namespace sgi {

// The steps as indices of the stream.
struct TextureIndices {
  int step = 0;
  std::vector<int32_t> ratios;  // [C - 1]
  std::array<int, 2> slopes{};
  std::array<int, 3> excess{};
  bool has_contrast = false;
  TextureColours colours;

  TextureSteps steps() const;
  std::array<float, 3> added() const;  // to magnitudes 1, 2 and larger ones
};

struct CodedTexture {
  TextureIndices indices;
  TextureField field;
  TextureCells cells;
};

// The state of the adaptive models with which a layer begins.
const BitModels &shipped_texture_models();

// A tile's layer, none where it has none. Throws Error: limit for a tile that is too large or takes more memory,
// unsupported for models of another number, corrupt.
std::optional<CodedTexture> read_texture_part(SymbolReader &reader, int64_t width, int64_t height, int channels,
                                              int64_t memory = kAnyMemory);

}  // namespace sgi
