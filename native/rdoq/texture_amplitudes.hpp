// What a tile's texture layer should show, as the amplitudes that cells of every size would need.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "bitstream/texture_field.hpp"
#include "model/texture_colours.hpp"
#include "model/texture_steps.hpp"
#include "rdoq/texture_transform.hpp"

namespace sgi {

class TextureAmplitudes {
 public:
  // planes: [C, height, width] of the roots (multiples of 32) in the tile's channels; colours: in which amplitudes are.
  TextureAmplitudes(const float *planes, int channels, const TextureLayout &layout, int threads,
                    const TextureColours &colours);

  // Moves them up the gradient of a score, planes like those of the constructor, which a layer should not follow far:
  // an amplitude moves by its step times what its step gains, in units in which the mean of that is `mean`, and at most
  // `most`; one below a step moves as much less. contrast: [roots], indices; log_size: as in TextureField, of a layer
  // whose cells alone are moved, null for all.
  void move(const float *gradient, const int8_t *contrast, const TextureSteps &steps, float mean, float most,
            const uint8_t *log_size);

  const float *of(const TextureCell &cell, int channel) const {
    return sizes_[cell.log - kTextureLeast].get() + (channel * height + cell.y) * width + cell.x;
  }

  // By which a channel, but the first, should make good what symbols leave of the first one.
  float share(int channel) const { return channel < 3 ? shares_[channel] : 0; }

  int threads, channels;
  TextureLayout layout;
  int64_t width, height;  // of the roots

 private:
  std::vector<float> in_colours(const float *planes, const std::array<double, 9> &mix) const;

  TextureColours colours_;
  std::array<float, 3> shares_{};
  std::array<std::unique_ptr<float[]>, kTextureSizes> sizes_;  // [C, height, width]
  std::unique_ptr<float[]> gains_;                             // the same, of the last move
};

}  // namespace sgi
