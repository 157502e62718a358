// Sums over the pixels around one Gaussian: what replacing it by others needs of an instruction set.
#pragma once
#include <cstdint>

#include "raster/tile_kernel.hpp"

namespace sgi {

// Pixels around one Gaussian, in a picture's coordinates. Kernels work on whole vectors: rows are `stride` long, a
// multiple of every vector, in working planes and in pictures alike, and G is zero beyond `width`.
struct Window {
  int x, y, width, height;
  int stride;
  bool empty() const { return width <= 0 || height <= 0; }
  int64_t size() const { return int64_t(stride) * height; }
};

constexpr int kWindowPadding = 16;

// Samples seen through a window: the first one, and how far rows are apart.
struct Plane {
  float *first;
  int64_t row;
};

// Weights of the squared error at each pixel, seen through a window.
struct WeightPlane {
  const float *first;
  int64_t row;
};

struct WindowKernel {
  // out = G, zero beyond the window's width.
  void (*draw)(const Splat &, const Window &, float *out);
  // out += factor * samples; out is a working plane.
  void (*add_scaled)(const Plane &, const Window &, float factor, float *out);
  // The sum of samples * g; g is a working plane.
  float (*inner)(const Plane &, const Window &, const float *g);
  // samples -= factor * g; g is a working plane.
  void (*subtract)(const Plane &, const Window &, float factor, const float *g);
  // out = weights * g; g and out are working planes.
  void (*weigh)(const WeightPlane &, const Window &, const float *g, float *out);
  // For each of two Gaussians G the sum of e (power e - 2 mixed) with e = G - g: how the squared error changes when one
  // whose colour has the square `power` becomes G after being g, `mixed` being the residual times its colour.
  void (*changes)(const Splat *two, const Window &, float power, const float *mixed, const float *g, float *out);
  // The same with every pixel's error times its weight.
  void (*weighted_changes)(const Splat *two, const Window &, const WeightPlane &, float power, const float *mixed,
                           const float *g, float *out);
  static const WindowKernel portable, avx2, avx512;
};

}  // namespace sgi
