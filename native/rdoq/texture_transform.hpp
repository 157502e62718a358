// The lapped transform of the texture layer: the amplitudes that every cell of a size would need.
#pragma once
#include <cstdint>

namespace sgi {

// plane [height, width], multiples of 32, to amplitudes [height, width]: those of a cell [n, n] where its pixels are.
void analyse_texture(const float *plane, int64_t width, int64_t height, int log, float *amplitudes);

}  // namespace sgi
