#include "bitstream/texture_cells.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "model/texture_quantizer.hpp"

namespace sgi {

namespace {

class Collection {
 public:
  Collection(const TextureField &field, const TextureSteps &steps, const float *excess, const TextureColours &colours)
      : field_(field), steps_(steps), excess_(excess), mixed_(!colours.same()), mix_(colours.matrix()) {
    const auto free = std::count(field.log_size.begin(), field.log_size.end(), 0);
    found.amplitudes.resize(size_t(field.channels) * size_t(field.unit_count() - free) * kUnit * kUnit);
  }

  void node(const TextureCell &cell) {
    const int log = field_.log_size[field_.unit(cell.x, cell.y)];
    if (log == cell.log) return leaf(cell);
    if (cell.log == kTextureLeast) return;
    for (int number = 0; number < 4; ++number) node(cell.child(number));
  }

  TextureCells found;

 private:
  void leaf(const TextureCell &cell) {
    found.corner.insert(found.corner.end(), {int32_t(cell.x), int32_t(cell.y)});
    found.log_size.push_back(uint8_t(cell.log));
    float *first = found.amplitudes.data() + at_;
    for (int channel = 0; channel < field_.channels; ++channel) amplitudes(cell, channel);
    if (mixed_) mix_colours(mix_, first, int64_t(cell.side()) * cell.side());
  }

  void amplitudes(const TextureCell &cell, int channel) {
    const float step = steps_.of(channel, field_.contrast[field_.root(cell.x, cell.y)]);
    const float *growth = steps_.growth(channel, cell.log);
    const int16_t *symbols = field_.at(channel, cell);
    const int diagonals = coded_diagonals(symbols, cell.side());
    float *to = found.amplitudes.data() + at_;
    QuantizerState state;
    for (const int index : texture_scan(cell.log)) {
      const int u = index & (cell.side() - 1), v = index >> cell.log;
      if (u + v >= diagonals) break;
      const int symbol = symbols[v * field_.width + u];
      if (symbol) {
        const float magnitude = state.magnitude(symbol) + excess_[std::min(std::abs(symbol), 3) - 1];
        to[index] = (symbol < 0 ? -magnitude : magnitude) * step * growth[index];
      }
      if (field_.dependent) state = state.after(symbol);
    }
    at_ += int64_t(cell.side()) * cell.side();
  }

  // One more than the last diagonal that may have a symbol.
  int coded_diagonals(const int16_t *symbols, int side) const {
    constexpr int kAtOnce = 4;
    int found = 0;
    for (int v = 0; v < side; ++v)
      for (int end = side; v + end > found; end -= kAtOnce) {
        uint64_t some;
        std::memcpy(&some, symbols + v * field_.width + end - kAtOnce, sizeof some);
        if (some) found = v + end;
      }
    return found;
  }

  const TextureField &field_;
  const TextureSteps &steps_;
  const float *excess_;
  const bool mixed_;
  const std::array<double, 9> mix_;
  int64_t at_ = 0;  // of the next amplitude
};

}  // namespace

TextureCells texture_cells(const TextureField &field, const TextureSteps &steps, const float *excess,
                           const TextureColours &colours) {
  Collection all(field, steps, excess, colours);
  for (int64_t y = 0; y < field.height; y += 1 << kTextureRoot)
    for (int64_t x = 0; x < field.width; x += 1 << kTextureRoot) all.node({x, y, kTextureRoot});
  return std::move(all.found);
}

}  // namespace sgi
