// The lapped transform of a cell as two products of matrices.
#include <cstring>

#include "base/inline.hpp"
#include "model/texture_axis.hpp"
#include "rdoq/texture_transform_kernel.hpp"

namespace sgi {
namespace {

constexpr int kRows = LANES == 16 ? 8 : 4;  // of a product at a time, of two vectors of columns: as registers hold

template <int WIDTH>
struct Vector {
  typedef float type __attribute__((vector_size(4 * WIDTH)));  // GCC takes no such `using`
};

// [kRows, WIDTH * COUNT] of a product of a [rows, LENGTH], whose values are so far apart, and b [LENGTH, SIDE].
template <int LENGTH, int SIDE, int WIDTH, int COUNT>
SGI_INLINE void multiply_part(const float *a, int row, int column, const float *b, float *out, int64_t stride) {
  using V = typename Vector<WIDTH>::type;
  V sums[kRows][COUNT] = {};
  for (int i = 0; i < LENGTH; ++i) {
    V values[COUNT];
    for (int v = 0; v < COUNT; ++v) std::memcpy(&values[v], b + i * SIDE + v * WIDTH, sizeof(V));
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r)
      for (int v = 0; v < COUNT; ++v) sums[r][v] += a[r * row + i * column] * values[v];
  }
  for (int r = 0; r < kRows; ++r)
    for (int v = 0; v < COUNT; ++v) std::memcpy(out + r * stride + v * WIDTH, &sums[r][v], sizeof(V));
}

template <int LENGTH, int SIDE>
void multiply(const float *a, int rows, int row, int column, const float *b, float *out, int64_t stride) {
  constexpr int kWidth = SIDE < LANES ? SIDE : LANES, kCount = SIDE / kWidth < 2 ? 1 : 2;
  for (int x = 0; x < SIDE; x += kWidth * kCount)
    for (int y = 0; y < rows; y += kRows)
      multiply_part<LENGTH, SIDE, kWidth, kCount>(a + y * row, row, column, b + x, out + y * stride + x, stride);
}

template <int SIDE>
void transform_as(const float *pixels, const float *across, const float *down, float *out, int64_t stride) {
  constexpr int kLength = SIDE + 2 * kTextureOverlap;
  float held[kLength * SIDE];
  multiply<kLength, SIDE>(pixels, kLength, kLength, 1, across, held, SIDE);
  multiply<kLength, SIDE>(down, SIDE, 1, SIDE, held, out, stride);
}

void transform(const float *pixels, int side, const float *across, const float *down, float *out, int64_t stride) {
  if (side == 8) return transform_as<8>(pixels, across, down, out, stride);
  if (side == 16) return transform_as<16>(pixels, across, down, out, stride);
  transform_as<32>(pixels, across, down, out, stride);
}

}  // namespace

const TextureTransformKernel TextureTransformKernel::SGI_ISA{sgi::transform};

}  // namespace sgi
