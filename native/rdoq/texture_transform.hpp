// The lapped transform of the texture layer: the amplitudes that every cell of a size would need.
#pragma once
#include <cstdint>

namespace sgi {

// plane [height, width], multiples of 32, to amplitudes [height, width]: those of a cell [n, n] where its pixels are.
// log_size [height / 8, width / 8]: as in TextureField, of a layer whose cells alone are looked at; amplitudes
// elsewhere are 0. Null for all cells.
void analyse_texture(const float *plane, int64_t width, int64_t height, int log, float *amplitudes,
                     const uint8_t *log_size = nullptr);

}  // namespace sgi
