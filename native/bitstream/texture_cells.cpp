#include "bitstream/texture_cells.hpp"

#include <algorithm>
#include <cstdlib>

#include "base/thread_pool.hpp"
#include "model/texture_quantizer.hpp"

namespace sgi {

namespace {

class Collection {
 public:
  Collection(const TextureField &field, const TextureSteps &steps, const float *excess, const TextureColours &colours)
      : field_(field), steps_(steps), excess_(excess), mixed_(!colours.same()), mix_(colours.matrix()) {
    for (int64_t y = 0; y < field.height; y += 1 << kTextureRoot)
      for (int64_t x = 0; x < field.width; x += 1 << kTextureRoot) node({x, y, kTextureRoot});
    found.amplitudes.reset(new float[size_t(count_)]);
    found.amplitude_count = count_;
    found.waves.resize(found.log_size.size() * size_t(field.channels));
  }

  // Finds the amplitudes of all cells.
  void fill(int threads) {
    const auto cells = int64_t(found.log_size.size());
    parallel_for((cells + kAtOnce - 1) / kAtOnce, threads, [&](int64_t part) {
      for (int64_t i = part * kAtOnce; i < std::min(cells, (part + 1) * kAtOnce); ++i) cell(size_t(i));
    });
  }

  TextureCells found;

 private:
  static constexpr int64_t kAtOnce = 32;  // cells

  void node(const TextureCell &cell) {
    const int log = field_.log_size[field_.unit(cell.x, cell.y)];
    if (log == cell.log) {
      found.corner.insert(found.corner.end(), {int32_t(cell.x), int32_t(cell.y)});
      found.log_size.push_back(uint8_t(cell.log));
      first_.push_back(count_);
      count_ += int64_t(field_.channels) << 2 * cell.log;
      return;
    }
    if (cell.log == kTextureLeast) return;
    for (int number = 0; number < 4; ++number) node(cell.child(number));
  }

  void cell(size_t number) {
    const TextureCell cell{found.corner[2 * number], found.corner[2 * number + 1], found.log_size[number]};
    const int64_t size = int64_t(1) << 2 * cell.log;
    float *first = found.amplitudes.get() + first_[number];
    std::fill_n(first, field_.channels * size, 0.0f);
    Waves *const waves = &found.waves[number * size_t(field_.channels)];
    for (int channel = 0; channel < field_.channels; ++channel)
      waves[channel] = amplitudes(cell, channel, first + channel * size);
    if (!mixed_) return;
    mix_colours(mix_, first, size);
    for (int channel = 1; channel < 3; ++channel)
      for (int other = 0; other < 3; ++other) waves[channel] = joined(waves[channel], waves[other]);
  }

  static Waves joined(Waves a, Waves b) { return {std::max(a.down, b.down), std::max(a.across, b.across)}; }

  Waves amplitudes(const TextureCell &cell, int channel, float *to) const {
    const float step = steps_.of(channel, field_.contrast[field_.root(cell.x, cell.y)]);
    const float *growth = steps_.growth(channel, cell.log);
    const int16_t *symbols = field_.at(channel, cell);
    const int last = field_.last_at_most(channel, cell);
    const float excess[] = {0.5f, excess_[0], excess_[1], excess_[2]};  // the first lets no symbol be +0 in both states
    QuantizerState state;
    int down = 0, across = 0;
    for (const Frequency &at : texture_scan(cell.log)) {
      if (at.diagonal() > last) break;
      const int symbol = symbols[at.v * field_.width + at.u];
      const auto sign = float((symbol > 0) - (symbol < 0));  // no branch, which nothing could predict
      to[at.index] = sign * (state.magnitude(symbol) + excess[std::min(std::abs(symbol), 3)]) * step * growth[at.index];
      state = state.after(symbol);
      if (!symbol) continue;
      down = std::max(down, at.v + 1), across = std::max(across, at.u + 1);
    }
    return {uint8_t((down + 3) / 4 * 4), uint8_t(across)};
  }

  const TextureField &field_;
  const TextureSteps &steps_;
  const float *excess_;
  const bool mixed_;
  const std::array<double, 9> mix_;
  std::vector<int64_t> first_;  // amplitude of each cell
  int64_t count_ = 0;           // of amplitudes
};

}  // namespace

TextureCells texture_cells(const TextureField &field, const TextureSteps &steps, const float *excess,
                           const TextureColours &colours, int threads) {
  Collection all(field, steps, excess, colours);
  all.fill(threads);
  return std::move(all.found);
}

}  // namespace sgi
