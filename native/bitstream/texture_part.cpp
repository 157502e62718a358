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

template <class Coder>
void code_indices(Coder &coder, int channels, TextureIndices &indices) {
  coder.number(kStepBits, indices.step);
  indices.ratios.resize(size_t(channels - 1));
  coder.values(kRatioBits, indices.ratios), coder.values(kSlopeBits, indices.slopes);
  coder.values(kExcessBits, indices.excess);
  coder.number(1, indices.has_contrast);
  TextureGrid &grid = indices.grid;
  coder.number(1, grid.separate);
  if (grid.separate) coder.number(kGridBits, grid.left), coder.number(kGridBits, grid.top);
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

template <class Coder>
void code_texture_indices(Coder &coder, int64_t width, int64_t height, int channels,
                          std::optional<TextureIndices> &indices, int64_t memory) {
  bool has_texture = indices.has_value();
  coder.number(1, has_texture);
  if (!has_texture) return;
  if (Coder::kReads) indices.emplace();
  TextureColours &colours = indices->colours;
  int models = colours.same() ? kPlain : kColoured;
  coder.number(kModelsBits, models);
  if (models != kPlain && models != kColoured)
    throw Error(Fault::unsupported, "texture: models " + std::to_string(models) + "; this program has models 2 and 3");
  code_indices(coder, channels, *indices);
  if (models == kColoured) {
    if (channels < 3) throw Error(Fault::corrupt, "texture: colours of " + std::to_string(channels) + " channels");
    coder.values(kShareBits, colours.shares), coder.number(kTurnBits, colours.turn);
    if (colours.same()) throw Error(Fault::corrupt, "texture: colours that are no others than those without");
  }
  const auto sides = indices->grid.layer_sides(width, height);
  check_texture(channels, sides.first, sides.second, memory);
}

template void code_texture_indices(SymbolReader &coder, int64_t width, int64_t height, int channels,
                                   std::optional<TextureIndices> &indices, int64_t memory);

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

void write_texture_part(SymbolWriter &writer, const std::optional<CodedTexture> &texture, int64_t width, int64_t height,
                        int channels) {
  std::optional<TextureIndices> indices;
  if (texture) indices = texture->indices;
  code_texture_indices(writer, width, height, channels, indices);
  if (!texture) return;
  const auto sides = indices->grid.layer_sides(width, height);
  BitModels models = shipped_texture_models();
  const std::vector<int32_t> symbols =
      write_texture(models, writer.range(), texture->field, sides.first, sides.second, indices->has_contrast);
  writer.record(symbols.data(), int64_t(symbols.size()));
}

}  // namespace sgi
