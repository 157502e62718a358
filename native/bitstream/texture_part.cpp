#include "bitstream/texture_part.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "base/error.hpp"
#include "base/exact.hpp"
#include "bitstream/limits.hpp"
#include "bitstream/shipped.hpp"
#include "bitstream/texture_context.hpp"
#include "bitstream/texture_stream.hpp"

namespace sgi {
namespace {

constexpr int kModelsBits = 4, kStepBits = 9, kRatioBits = 5, kSlopeBits = 5, kExcessBits = 4, kShareBits = 6,
              kTurnBits = 4, kGridBits = 3;
static_assert(1 << kGridBits == kTextureGridSteps);
constexpr int kStepOfOne = 480, kSameStep = 16, kNoExcess = 8;
// What a layer says about its colours.
constexpr int kPlain = 2, kColoured = 3;

BitModels shipped_models() {
  BitModels models = fresh_texture_models();
  if (!models.start(shipped_texture())) throw std::logic_error("texture models of another size");
  return models;
}

TextureGrid read_grid(SymbolReader &reader) {
  TextureGrid grid;
  grid.separate = reader.number(1);
  if (!grid.separate) return grid;
  const std::vector<int32_t> before = reader.values(kGridBits, 2);
  grid.left = before[0], grid.top = before[1];
  return grid;
}

TextureIndices read_indices(SymbolReader &reader, int channels) {
  TextureIndices indices;
  indices.step = reader.number(kStepBits);
  indices.ratios = reader.values(kRatioBits, channels - 1);
  const std::vector<int32_t> slopes = reader.values(kSlopeBits, 2), excess = reader.values(kExcessBits, 3);
  indices.slopes = {slopes[0], slopes[1]};
  indices.excess = {excess[0], excess[1], excess[2]};
  indices.has_contrast = reader.number(1);
  indices.grid = read_grid(reader);
  return indices;
}

TextureColours read_colours(SymbolReader &reader) {
  const std::vector<int32_t> shares = reader.values(kShareBits, 2);
  const TextureColours colours{{shares[0], shares[1]}, reader.number(kTurnBits)};
  if (colours.same()) throw Error(Fault::corrupt, "texture: colours that are no others than those without");
  return colours;
}

}  // namespace

TextureSteps TextureIndices::steps() const {
  const double first = power_of_two(step - kStepOfOne);
  std::vector<float> channel{float(first)};
  for (const int32_t ratio : ratios) channel.push_back(float(first * power_of_two(4 * (ratio - kSameStep))));
  return {std::move(channel), {float(slopes[0]) / 2, float(slopes[1]) / 2}};
}

std::array<float, 3> TextureIndices::added() const {
  std::array<float, 3> added{};
  for (size_t i = 0; i < added.size(); ++i) added[i] = float(excess[i] - kNoExcess) / 32;
  return added;
}

const BitModels &shipped_texture_models() {
  static const BitModels models = shipped_models();
  return models;
}

std::optional<TextureIndices> read_texture_indices(SymbolReader &reader, int64_t width, int64_t height, int channels,
                                                   int64_t memory) {
  if (!reader.number(1)) return std::nullopt;
  const int models = reader.number(kModelsBits);
  if (models != kPlain && models != kColoured)
    throw Error(Fault::unsupported, "texture: models " + std::to_string(models) + "; this program has models 2 and 3");
  TextureIndices indices = read_indices(reader, channels);
  if (models == kColoured) {
    if (channels < 3) throw Error(Fault::corrupt, "texture: colours of " + std::to_string(channels) + " channels");
    indices.colours = read_colours(reader);
  }
  const auto sides = indices.grid.layer_sides(width, height);
  check_texture(channels, sides.first, sides.second, memory);
  return indices;
}

CodedTexture read_texture_layer(SymbolReader &reader, TextureIndices indices, int64_t width, int64_t height,
                                int channels) {
  const auto sides = indices.grid.layer_sides(width, height);
  TextureField field = empty_field(sides.first, sides.second, channels);
  read_texture(shipped_texture_models(), reader, sides.first, sides.second, indices.has_contrast, field, nullptr,
               nullptr);
  return {std::move(indices), std::move(field)};
}

void read_texture_cells(SymbolReader &reader, const TextureIndices &indices, int64_t width, int64_t height,
                        int channels, TextureCells &cells, const TextureRows &rows_read) {
  const auto sides = indices.grid.layer_sides(width, height);
  TextureField field = empty_field(sides.first, sides.second, channels, KeptSymbols::last_rows);
  TextureDequantizer dequantizer(indices.steps(), indices.added(), indices.colours, cells);
  cells.reserve(field);
  const auto told = [&](int64_t rows) {
    rows_read(rows - indices.grid.top, cells.texture(channels, width, height, indices.grid));
  };
  read_texture(shipped_texture_models(), reader, sides.first, sides.second, indices.has_contrast, field, &dequantizer,
               told);
}

}  // namespace sgi
