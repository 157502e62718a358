// The transforms of the texture layer: the amplitudes that every cell of a size would need.
#pragma once
#include <cstdint>

#include "bitstream/texture_field.hpp"

namespace sgi {

// Whether a cell of a size begins at pixel (x, y) in a layer. log_size: as in TextureField, null for all cells.
inline bool is_of_size(const uint8_t *log_size, int64_t width, int64_t x, int64_t y, int log) {
  return !log_size || log_size[y / kUnit * (width / kUnit) + x / kUnit] == log;
}

// Pixels of a layer, which has whole roots of them: those of its tile and those before it; separate: as in TextureGrid.
struct TextureLayout {
  int64_t width, height;
  bool separate = false;
};

// plane [height, width], multiples of 32, of a layer, to amplitudes [height, width]: those of a cell [n, n] where its
// pixels are. log_size [height / 8, width / 8]: as in TextureField, of a layer whose cells alone are looked at;
// amplitudes elsewhere stay as they are. Null for all cells.
void analyse_texture(const float *plane, int64_t width, int64_t height, const TextureLayout &layout, int log,
                     float *amplitudes, const uint8_t *log_size = nullptr);

}  // namespace sgi
