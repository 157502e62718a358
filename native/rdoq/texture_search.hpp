// The texture layer of least squared error plus lambda times bits.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/texture_field.hpp"
#include "bitstream/texture_models.hpp"
#include "model/texture_steps.hpp"

namespace sgi {

// What a tile's layer should show, as the amplitudes that cells of every size would need.
class TextureAmplitudes {
 public:
  // planes: [C, height, width] of the roots (multiples of 32); tile_width, tile_height: of the part that is seen.
  TextureAmplitudes(const float *planes, int channels, int64_t tile_width, int64_t tile_height, int threads);

  const float *of(const TextureCell &cell, int channel) const {
    return sizes_[cell.log - kTextureLeast].data() + (channel * height + cell.y) * width + cell.x;
  }

  int threads, channels;
  int64_t tile_width, tile_height, width, height;

 private:
  std::array<std::vector<float>, kTextureSizes> sizes_;  // [C, height, width]
};

struct TextureSettings {
  float lambda;  // squared steps per bit
  bool has_contrast;
};

struct TextureFound {
  TextureField field;
  double bits;
  // By magnitude 1, 2 and more: how many symbols, and the sum of |amplitude| / step - |symbol|.
  std::array<double, 3> count, excess;
  std::vector<float> cost;  // [roots] squared steps plus lambda times bits
};

// contrast: [roots], indices.
TextureFound search_texture(BitModels models, const TextureAmplitudes &amplitudes, const int8_t *contrast,
                            const TextureSteps &steps, const TextureSettings &settings);

}  // namespace sgi
