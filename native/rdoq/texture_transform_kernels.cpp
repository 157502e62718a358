// The lapped transform along one axis, in loops that compilers turn into vectors.
#include "model/texture_axis.hpp"
#include "rdoq/texture_transform_kernel.hpp"

namespace sgi {
namespace {

constexpr int kOverlap = kTextureOverlap, kAtOnce = 32;  // columns

template <int SIDE>
void along_as(const float *row, int64_t width, const float *const *atoms, float *out) {
  for (int64_t begin = 0; begin < width; begin += SIDE) {
    const float *values = atoms[(begin == 0) | (begin + SIDE == width ? 2 : 0)];
    float sums[SIDE] = {};
    for (int j = 0; j < SIDE + 2 * kOverlap; ++j) {
      const int64_t x = begin - kOverlap + j;
      if (x < 0 || x >= width) continue;
      for (int k = 0; k < SIDE; ++k) sums[k] += row[x] * values[j * SIDE + k];
    }
    for (int k = 0; k < SIDE; ++k) out[begin + k] = sums[k];
  }
}

void along(const float *row, int64_t width, int side, const float *const *atoms, float *out) {
  if (side == 8) return along_as<8>(row, width, atoms, out);
  if (side == 16) return along_as<16>(row, width, atoms, out);
  along_as<32>(row, width, atoms, out);
}

void down(const float *const *rows, int64_t width, int side, const float *atoms, float *out) {
  for (int64_t x = 0; x < width; x += kAtOnce)
    for (int k = 0; k < side; ++k) {
      float sums[kAtOnce] = {};
      for (int j = 0; j < side + 2 * kOverlap; ++j) {
        if (!rows[j]) continue;
        const float value = atoms[j * side + k], *row = rows[j] + x;
        for (int i = 0; i < kAtOnce; ++i) sums[i] += value * row[i];
      }
      for (int i = 0; i < kAtOnce; ++i) out[k * width + x + i] = sums[i];
    }
}

}  // namespace

const TextureTransformKernel TextureTransformKernel::SGI_ISA{sgi::along, sgi::down};

}  // namespace sgi
