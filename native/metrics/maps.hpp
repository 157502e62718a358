// The maps of SSIMULACRA 2 as its kernels see them: which there are, planes that hold them, sums, slopes.
#pragma once
#include <cstdint>

#include "base/inline.hpp"

namespace sgi {

// The maps of a channel at a scale, each of which counts by its mean and its 4-norm: loss of structure (1 - SSIM),
// edges that the decoded picture adds, edges that it loses.
enum VisualMap { kStructure, kAdded, kLost, kVisualMaps };

// Rows are padded to whole vectors of any instruction set.
constexpr int64_t kRowPadding = 16;
SGI_INLINE constexpr int64_t padded(int64_t width) { return (width + kRowPadding - 1) / kRowPadding * kRowPadding; }
// Floats of a row of scratch memory.
SGI_INLINE constexpr int64_t scratch_row(int64_t width) { return padded(width) + 2 * kRowPadding; }

// [height][padded(width)]
struct MapPlane {
  int64_t width, height;
};

// Sums over pixels [map][1, 4]: of a map, and of its fourth powers.
struct MapSums {
  double sum[2 * kVisualMaps];
};

// Of a pixel's value t > 0 in a map, the score's derivative is linear + cubic t^3.
struct MapSlope {
  float linear, cubic;
};

}  // namespace sgi
