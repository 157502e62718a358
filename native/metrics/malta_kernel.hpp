// Malta, a filter of Butteraugli: differences of pixels that lie along lines count more than scattered ones.
//
// Source: libjxl 0.7, lib/jxl/butteraugli/butteraugli.cc.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

// Nine pixels long with few gaps, or with every other pixel.
enum class MaltaLines { kFine, kCoarse };

constexpr int kMaltaReach = 4;      // rows and columns to each side
constexpr int kMaltaRingRows = 16;  // row y lies at y modulo this
constexpr int kMaxMaltaLines = 16;

// What differences count: all of them, and those by which a pixel is farther from 0 or nearer than the original is.
struct MaltaWeights {
  float all, outside, norm;

  // weight, norm: as libjxl has them; asymmetry: how much less it counts that something is added.
  MaltaWeights(MaltaLines lines, double weight, double norm, double asymmetry);
};

struct MaltaKernel {
  // Weighted differences of a row.
  void (*move)(const float *original, const float *seen, int64_t width, const MaltaWeights &weights, float *moved);

  // Adds the squared sums along all lines through each pixel of a row. `moved`: in a border of kMaltaReach.
  void (*add)(MaltaLines lines, const float *moved, int64_t stride, int64_t width, float *sums);

  // The derivatives in these sums, to rows of rings; slope: those in the squares.
  void (*slopes)(MaltaLines lines, const float *moved, int64_t stride, int64_t width, const float *slope, float *rings,
                 int64_t y, int64_t ring_stride);

  // The gradient in a row of what is seen. rings [lines][kMaltaRingRows][ring_stride]: with a border of columns.
  void (*gather)(MaltaLines lines, const float *rings, int64_t y, int64_t ring_stride, const float *original,
                 const float *seen, int64_t width, const MaltaWeights &weights, float *gradient);

  static const MaltaKernel portable, avx2, avx512;
};

}  // namespace sgi
