// Step sizes of texture symbols (docs/format.md, "Texture").
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "model/texture_axis.hpp"

namespace sgi {

class TextureSteps {
 public:
  // channel: [C] step of the lowest frequency; steps grow by slope[0] of it towards the highest frequency of the first
  // channel, by slope[1] in the others.
  TextureSteps(std::vector<float> channel, const std::array<float, 2> &slope) : channel_(std::move(channel)) {
    for (int kind = 0; kind < 2; ++kind)
      for (int size = 0; size < kTextureSizes; ++size) {
        const int side = 1 << (kTextureLeast + size);
        for (int diagonal = 0; diagonal < 2 * side - 1; ++diagonal)
          growth_[kind][size][diagonal] = 1 + slope[kind] * float(diagonal + 1) / float(2 * side);
      }
  }

  int channels() const { return int(channel_.size()); }
  // Of a channel in a root of this contrast: quarters of an octave.
  float of(int channel, int contrast) const { return channel_[channel] * std::exp2(float(contrast) / 4); }
  // By which a step grows at the diagonals of a cell.
  const float *growth(int channel, int log) const { return growth_[channel > 0][log - kTextureLeast].data(); }

 private:
  std::vector<float> channel_;
  std::array<std::array<std::array<float, (2 << kTextureRoot) - 1>, kTextureSizes>, 2> growth_;
};

}  // namespace sgi
