// Rows of the maps of SSIMULACRA 2 in one channel at one scale: loss of structure, added edges, lost edges. The decoded
// picture is given as its difference from the reference: so all stays exact where they are nearly equal.
#pragma once
#include <cstdint>

#include "base/isa.hpp"
#include "metrics/maps.hpp"

namespace sgi {

// Planes of the reference. Null where only edges count: variance.
struct ReferencePlanes {
  const float *value, *mean, *variance;
};

// The score's derivatives in the blurs of the difference e from the reference r: of e; of e^2 and of r e, which only
// structure needs; and in e where it is not blurred.
struct BlurSlopes {
  float *one, *square, *product, *direct;
};

constexpr int kNeighbourRows = 5;  // to each side, that a blurred row takes
constexpr int kScratchRows = 3;    // of scratch_row(width) floats
constexpr int kRingRows = 16;      // row y lies at y modulo this

struct StructureKernel {
  // Mean and, if not null, variance around the pixels of a row of the reference. `scratch`: kScratchRows rows.
  void (*describe)(const float *value, MapPlane plane, int64_t y, float *mean, float *variance, float *scratch);

  // Adds the maps of a row to the sums.
  void (*compare)(const ReferencePlanes &reference, const float *difference, MapPlane plane, int64_t y, MapSums &sums,
                  float *scratch);

  // The score's derivatives in the blurs of a row, to the rows of `out`.
  void (*slope)(const ReferencePlanes &reference, const float *difference, MapPlane plane, int64_t y,
                const MapSlope *slopes, const BlurSlopes &out, float *scratch);

  // The gradient in a row of differences. `slopes`: rings of kRingRows rows of what `slope` found.
  void (*gather)(const ReferencePlanes &reference, const float *difference, const BlurSlopes &slopes, MapPlane plane,
                 int64_t y, float *gradient, float *scratch);

  static const StructureKernel portable, avx2, avx512;
};

}  // namespace sgi
