// The texture layer of least squared error plus lambda times bits.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "bitstream/texture_field.hpp"
#include "bitstream/texture_models.hpp"
#include "model/texture_steps.hpp"

namespace sgi {

struct TextureSettings {
  float lambda;      // squared steps per bit
  int least_log;     // of cells
  bool has_contrast;
  int threads;
};

struct TextureFound {
  TextureField field;
  double bits;
  // By magnitude 1, 2 and more: how many symbols, and the sum of |amplitude| / step - |symbol|.
  std::array<double, 3> count, excess;
};

// planes: [C, height, width] of the roots (multiples of 32), what the layer should show; tile_width, tile_height: of
// the part that is seen. contrast: [roots], indices.
TextureFound search_texture(BitModels models, const float *planes, int64_t tile_width, int64_t tile_height,
                            const int8_t *contrast, const TextureSteps &steps, const TextureSettings &settings);

}  // namespace sgi
