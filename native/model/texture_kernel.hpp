// What drawing a texture cell needs of an instruction set.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

// A channel of a cell of `side` pixels and a part of what it reaches.
struct TexturePart {
  const float *amplitudes;  // [side, side], of which the first `waves_down` rows and `waves_across` columns count;
  int side, waves_down, waves_across;  // rows are a multiple of four
  const float *across;  // [side, across_stride]: a basis function's values at the part's columns; 16 more may be read
  int64_t across_stride;
  const float *down;  // [rows, side]: all basis functions at each row
  int rows, columns;
};

struct TextureKernel {
  // out [rows, columns], `stride` apart, += down * amplitudes * across; up to 15 columns behind the last change too.
  void (*add)(const TexturePart &part, float *out, int64_t stride);
  static const TextureKernel portable, avx2, avx512;
};

}  // namespace sgi
