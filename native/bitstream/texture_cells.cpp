#include "bitstream/texture_cells.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace sgi {
namespace {

constexpr int64_t kPiece = 1 << 15;  // floats; small enough to be memory that was used before
constexpr int kWaves = 4;            // rows are there by fours

}  // namespace

void TextureCells::reserve(const TextureField &field) {
  const int64_t cells = field.unit_count();
  corner.reserve(size_t(2 * cells)), log_size.reserve(size_t(cells));
  amplitudes.reserve(size_t(cells * field.channels)), waves.reserve(size_t(cells * field.channels));
  floats_to_come = field.channels * field.width * field.height;
}

Texture TextureCells::texture(int channels, int64_t width, int64_t height, TextureGrid grid) const {
  const auto count = int64_t(log_size.size());
  return {corner.data(), log_size.data(), amplitudes.data(), waves.data(), count, channels, width, height, grid};
}

TextureDequantizer::TextureDequantizer(const TextureSteps &steps, const std::array<float, 3> &excess,
                                       const TextureColours &colours, TextureCells &found)
    : found_(found), steps_(steps),
      excess_{0.5f, excess[0], excess[1], excess[2]},  // the first lets no symbol be +0 in both states
      mixed_(!colours.same()), mix_(colours.matrix()), values_(size_t(steps.channels())) {}

void TextureDequantizer::begin(const TextureCell &cell, int contrast) {
  found_.corner.insert(found_.corner.end(), {int32_t(cell.x), int32_t(cell.y)});
  found_.log_size.push_back(uint8_t(cell.log));
  log_ = cell.log, contrast_ = contrast, channel_ = 0;
  const int64_t size = steps_.channels() * plane();
  if (size > room_) {
    room_ = std::max(size, std::min(kPiece, found_.floats_to_come));
    next_ = found_.memory.emplace_back().room(room_);
    found_.floats += room_;
  }
  found_.floats_to_come -= size;
}

void TextureDequantizer::channel(const int16_t *values, int64_t stride, int last) {
  const Values &small = values_of(channel_);
  const float *growth = steps_.growth(channel_, log_);
  float *const to = next_;
  std::fill_n(to, std::min(plane(), int64_t(last + kWaves) / kWaves * kWaves << log_), 0.0f);
  QuantizerState state;
  int down = 0, across = 0;
  for (const Frequency &at : texture_scan(log_)) {
    if (at.diagonal() > last) break;
    const int symbol = values[at.v * stride + at.u];
    const bool is_small = unsigned(symbol + kSmall) <= 2 * kSmall;
    const float value =
        is_small ? small.of[state.odd()][symbol + kSmall] : value_of(symbol, state, steps_.of(channel_, contrast_));
    to[at.index] = value * growth[at.index];
    state = state.after(symbol);
    if (!symbol) continue;
    down = std::max(down, at.v + 1), across = std::max(across, at.u + 1);
  }
  const int rows = (down + kWaves - 1) / kWaves * kWaves;
  found_.waves.push_back({uint8_t(rows), uint8_t(across)});
  found_.amplitudes.push_back(to);
  take(mixed_ ? plane() : int64_t(rows) << log_);
  ++channel_;
}

// What a symbol stands for at the lowest frequency.
float TextureDequantizer::value_of(int symbol, QuantizerState state, float step) const {
  const auto sign = float((symbol > 0) - (symbol < 0));
  return sign * (state.magnitude(symbol) + excess_[size_t(std::min(std::abs(symbol), 3))]) * step;
}

// Those of small symbols of a channel in a root of the cell's contrast.
const TextureDequantizer::Values &TextureDequantizer::values_of(int channel) {
  Values &values = values_[size_t(channel)];
  if (values.contrast == contrast_) return values;
  const float step = steps_.of(channel, contrast_);
  for (int odd = 0; odd < 2; ++odd)
    for (int symbol = -kSmall; symbol <= kSmall; ++symbol)
      values.of[odd][symbol + kSmall] = value_of(symbol, QuantizerState(odd), step);
  values.contrast = contrast_;
  return values;
}

// Colours of texture are mixed where they were read, and moved up to each other. The first channel stays as it is.
void TextureDequantizer::end() {
  if (!mixed_) return;
  Waves *const waves = &found_.waves[found_.waves.size() - size_t(channel_)];
  Waves most;
  for (int c = 0; c < 3; ++c) most = {std::max(most.down, waves[c].down), std::max(most.across, waves[c].across)};
  float *const first = next_ - channel_ * plane();
  for (int c = 0; c < 3; ++c)
    std::fill(first + c * plane() + (waves[c].down << log_), first + c * plane() + (most.down << log_), 0.0f);
  mix_colours(mix_, first, plane(), most.down << log_);
  waves[1] = waves[2] = most;
  take(-channel_ * plane());
  for (int c = 0; c < channel_; ++c) {
    const float *from = first + c * plane();
    const int64_t floats = waves[c].down << log_;
    if (from != next_) std::copy_n(from, floats, next_);
    found_.amplitudes[found_.amplitudes.size() - size_t(channel_ - c)] = next_;
    take(floats);
  }
}

namespace {

void add_cells(const TextureField &field, const TextureCell &cell, TextureDequantizer &to) {
  const int log = field.log_size[field.unit(cell.x, cell.y)];
  if (log != cell.log) {
    if (cell.log > kTextureLeast)
      for (int number = 0; number < 4; ++number) add_cells(field, cell.child(number), to);
    return;
  }
  to.begin(cell, field.contrast[field.root(cell.x, cell.y)]);
  for (int channel = 0; channel < field.channels; ++channel)
    to.channel(field.at(channel, cell), field.width, field.last_at_most(channel, cell));
  to.end();
}

}  // namespace

void read_cells(const TextureField &field, TextureDequantizer &to) {
  for (int64_t y = 0; y < field.height; y += 1 << kTextureRoot)
    for (int64_t x = 0; x < field.width; x += 1 << kTextureRoot) add_cells(field, {x, y, kTextureRoot}, to);
}

}  // namespace sgi
