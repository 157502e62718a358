// The lapped transform of a cell of the texture layer: what it needs of an instruction set.
#pragma once
#include <cstdint>

namespace sgi {

// Amplitudes [side, side] of a cell, in rows `stride` apart. pixels [side + 2 overlap, side + 2 overlap]: of the cell
// and around it; across, down [side + 2 overlap, side]: what pixels weigh along a row and down a column. Sums are in
// the order of pixels, so that all instruction sets give the same.
struct TextureTransformKernel {
  void (*transform)(const float *pixels, int side, const float *across, const float *down, float *out, int64_t stride);
  static const TextureTransformKernel portable, avx2, avx512;
};

}  // namespace sgi
