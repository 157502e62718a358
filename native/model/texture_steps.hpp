// Step sizes of texture symbols (docs/format.md, "Texture").
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/exact.hpp"
#include "model/texture_axis.hpp"

namespace sgi {

class TextureSteps {
 public:
  // channel: [C] step of the lowest frequency; steps grow with the square of the frequency, by slope[0] of it towards
  // the highest one of the first channel, by slope[1] in the others.
  TextureSteps(std::vector<float> channel, const std::array<float, 2> &slope) : channel_(std::move(channel)) {
    for (int kind = 0; kind < 2; ++kind)
      for (int size = 0; size < kTextureSizes; ++size) {
        const int side = 1 << (kTextureLeast + size);
        for (int v = 0; v < side; ++v)
          for (int u = 0; u < side; ++u) {
            const int squared = (2 * u + 1) * (2 * u + 1) + (2 * v + 1) * (2 * v + 1);
            growth_[kind][size][v * side + u] = 1 + slope[kind] * float(squared) / float(8 * side * side);
          }
      }
  }

  int channels() const { return int(channel_.size()); }
  // Of a channel in a root of this contrast: quarters of an octave.
  float of(int channel, int contrast) const { return channel_[channel] * float(power_of_two(8 * contrast)); }
  // By which a step grows at the frequencies (v * n + u) of a cell of side n.
  const float *growth(int channel, int log) const { return growth_[channel > 0][log - kTextureLeast].data(); }

 private:
  std::vector<float> channel_;
  std::array<std::array<CellValues<float>, kTextureSizes>, 2> growth_;
};

}  // namespace sgi
