// What drawing a texture cell needs of an instruction set.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

// A channel of a cell of `side` pixels and a part of what it reaches.
struct TexturePart {
  const float *amplitudes;  // [side, side], of which the first `waves_down` rows and `waves_across` columns count
  int side, waves_down, waves_across;
  const float *across;  // [side, across_stride]: a basis function's values at the part's columns; 16 more may be read
  int64_t across_stride;
  const float *down;  // [rows, side]: all basis functions at each row
  int rows, columns;
};

struct TextureKernel {
  // out [rows, columns], `stride` apart, += down * amplitudes * across; up to 15 columns behind the last change too.
  void (*add)(const TexturePart &part, float *out, int64_t stride);
  // Of n values of three planes, `plane` apart: value i of out[c] is the sum over r of mix[r][c] * plane r. Up to 15
  // more values of planes may be read.
  void (*mix)(const float *mix, const float *planes, int64_t plane, int64_t n, float *const out[3]);
  static const TextureKernel portable, avx2, avx512;
};

}  // namespace sgi
