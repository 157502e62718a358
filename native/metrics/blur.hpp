// The Gaussian blur of SSIMULACRA 2: sigma 1.5, eleven taps. Rows beyond the top and bottom mirror those inside, the
// border included; columns beyond the sides are 0. So the blur is its own transpose.
#pragma once
#include "metrics/maps.hpp"
#include "metrics/rows.hpp"
#include "metrics/structure_kernel.hpp"

namespace sgi {
namespace {

constexpr int kReach = kNeighbourRows;
constexpr float kTaps[kReach + 1] = {0.2660117249f, 0.2130055377f, 0.1093606895f,
                                     0.0360007721f, 0.0075987581f, 0.0010283801f};

inline int64_t mirrored(int64_t y, int64_t height) { return y < 0 ? -1 - y : y >= height ? 2 * height - 1 - y : y; }

// The rows that a blurred row takes: of a whole plane, or of a ring in which row y lies at y modulo `ring`, a power of
// two.
struct BlurRows {
  const float *row[2 * kReach + 1];

  BlurRows(const float *plane, MapPlane size, int64_t y, int64_t ring = int64_t(1) << 62) {
    const int64_t stride = padded(size.width);
    for (int i = 0; i <= 2 * kReach; ++i)
      row[i] = plane + (mirrored(y + i - kReach, size.height) & (ring - 1)) * stride;
  }
  vf at(int offset, int64_t x) const { return load(row[kReach + offset] + x); }

  // The blur downward.
  vf sum(int64_t x) const {
    vf sum = kTaps[0] * at(0, x);
    for (int i = 1; i <= kReach; ++i) sum += kTaps[i] * (at(-i, x) + at(i, x));
    return sum;
  }
};

// A row that was blurred downward, with zeros to both sides, to be blurred across.
struct BlurColumns {
  float *row;

  // In memory of scratch_row(width) floats.
  BlurColumns(float *memory, int64_t width) : row(memory + kRowPadding) {
    std::memset(memory, 0, kRowPadding * sizeof(float));
    std::memset(row + padded(width), 0, kRowPadding * sizeof(float));
  }
  vf at(int64_t x) const {
    const float *p = row + x;
    vf sum = kTaps[0] * load(p);
    for (int i = 1; i <= kReach; ++i) sum += kTaps[i] * (load(p - i) + load(p + i));
    return sum;
  }
};

}  // namespace
}  // namespace sgi
