// The lapped transform of the texture layer along one axis: what it needs of an instruction set.
#pragma once
#include <cstdint>

namespace sgi {

// atoms [side + 2 overlap, side]: what the pixels of a cell, and those beside it that it laps over, weigh. Sums are in
// the order of pixels, so that all instruction sets give the same.
struct TextureTransformKernel {
  // Amplitudes along a row of cells, a multiple of 32 pixels. atoms: of cells that have a hard edge (+1) on the left
  // and (+2) on the right.
  void (*along)(const float *row, int64_t width, int side, const float *const *atoms, float *out);
  // Amplitudes [side, width] down rows of pixels [side + 2 overlap], null where there are none.
  void (*down)(const float *const *rows, int64_t width, int side, const float *atoms, float *out);
  static const TextureTransformKernel portable, avx2, avx512;
};

}  // namespace sgi
