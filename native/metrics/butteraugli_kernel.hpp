// Rows of Butteraugli's stages, and the way back of gradients through them. Stages that look at neighbours are in
// plane_blur.hpp and malta_kernel.hpp.
//
// Source: libjxl 0.7, lib/jxl/butteraugli/butteraugli.cc.
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

// Rows of one picture. Red against green is channel 0, brightness 1, blue 2; details of blue are not looked at. What is
// pointed at is of one type, const or not.
template <class T>
struct SeenRows {
  T *lf[3], *mf[3], *hf[2], *uhf[2];  // frequencies from low to ultra high
  T *mask;                            // how much is there that hides differences
};

// Rows of an original. details, ground: what squared differences of details and of the lowest frequencies count.
struct OriginalRows {
  SeenRows<const float> seen;
  const float *details, *ground;
};

// Rows of gradients on their way back: in mf; in hf and uhf, then in what of both is blurred; in the mask before its
// blur.
struct DetailGradients {
  float *hf[2], *uhf[2];
  const float *mask;
};

struct ButteraugliKernel {
  // What the eye sees of linear light. around: light, blurred.
  void (*opsin)(const float *const light[3], const float *const around[3], int64_t width, float *const out[3]);
  // Gradients in light and in blurred light, from those in `out`.
  void (*opsin_gradient)(const float *const light[3], const float *const around[3], const float *const gradient[3],
                         int64_t width, float *const in_light[3], float *const in_around[3]);

  // Takes the blur of a row of channels off it, which becomes lf.
  void (*split_low)(float *const opsin[3], float *const lf[3], int64_t width);
  // Takes the blur of what is left off it, which becomes mf. red: what is left of channel 0 where there is little
  // brightness to hide it.
  void (*split_middle)(float *const rest[3], float *const mf[3], float *red, int64_t width);
  // hf from the blur of what is left, and uhf.
  void (*split_high)(const float *red, const float *bright, float *const hf[2], float *const uhf[2], int64_t width);
  // What the mask is a blur of.
  void (*activity)(const float *const hf[2], const float *const uhf[2], int64_t width, float *activity);
  // What differences count where the mask, eroded, is so high.
  void (*visibility)(const float *eroded, int64_t width, float *details, float *ground);

  // Differences of pixels. lines: what Malta found of them, squared.
  void (*differences)(const OriginalRows &original, const SeenRows<const float> &seen, const float *lines,
                      int64_t width, float *out);
  // slope: gradient in the differences on entry, in squared differences of details on return; lf becomes the gradient
  // in the lowest frequencies, and `mask` that in the mask.
  void (*start_gradient)(const OriginalRows &original, const SeenRows<float> &seen, const float *differences,
                         int64_t width, float *slope, float *mask);
  // mf becomes the gradient in middle frequencies. lines: Malta's gradients in channels 0 and 1.
  void (*mf_gradient)(const OriginalRows &original, const float *slope, const float *const lines[2], int64_t width,
                      float *const mf[3]);
  // Gradients hf become those in the blur that hf was made of; in_red, in_bright: those in what was blurred.
  void (*high_gradient)(const OriginalRows &original, const SeenRows<const float> &seen, const float *slope,
                        const DetailGradients &gradients, int64_t width, float *in_red, float *in_bright);
  // Gradients in `red` and brightness become those in what is left of channels 0 and 1, and are taken off mf's.
  void (*suppression_gradient)(const float *rest_red, const float *rest_bright, int64_t width, float *const gradient[2],
                               float *const mf[2]);

  static const ButteraugliKernel portable, avx2, avx512;
};

}  // namespace sgi
