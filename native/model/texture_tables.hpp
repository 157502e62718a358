// What texture is rendered from elsewhere, such as on a GPU: tables of both axes, and cells by blocks of pixels.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

namespace sgi {

struct Texture;
struct OutputAxis;

constexpr int kTableBlock = 32;  // pixels of the side of a block
constexpr int kTableFields = 9;

// Fields of a cell: its side, where its amplitudes [C, side, side] begin; along x and then y its first pixel, how many
// it reaches, where its basis functions are in the table; between these the stride along x. Basis function k is at
// across[at + k * stride + pixel - first] and at down[at + (pixel - first) * side + k].
struct TextureTables {
  const float *amplitudes;
  int64_t amplitude_count;
  const float *mix;  // as of `draw_texture`
  std::vector<float> across, down;
  std::vector<int32_t> cells;  // [N, kTableFields]
  std::vector<int32_t> start;  // [blocks + 1], of those that a block shows ...
  std::vector<int32_t> shown;  // ... in their order
  int64_t blocks_across;
};

// Nothing where it is too much for 32 bits. The texture must outlive the tables.
std::optional<TextureTables> texture_tables(const Texture &texture, const OutputAxis &x, const OutputAxis &y,
                                            const float *mix);

}  // namespace sgi
