// From moments of a Gaussian's pixels to its gradients.
#pragma once
#include "raster/splat.hpp"

namespace sgi {
namespace {

// Carries moments [kMoments] through the inverse of a covariance (xx, xy, yy): gradients of the mean [2] and of the
// covariance [3].
inline void carry_moments(const float *covariance, const float *sum, float *mean, float *out) {
  mean[0] = mean[1] = out[0] = out[1] = out[2] = 0;
  if (sum[1] == 0 && sum[2] == 0 && sum[3] == 0 && sum[4] == 0 && sum[5] == 0) return;  // its inverse may be infinite
  const float all = sum[1] + sum[2] + sum[3] + sum[4] + sum[5];
  if (!(all - all == 0)) return;  // so far away that squares of distances are infinite
  const float xx = covariance[0], xy = covariance[1], yy = covariance[2];
  const double det = double(xx) * yy - double(xy) * xy;
  const float p = float(yy / det), q = float(-xy / det), s = float(xx / det);  // inverse covariance
  const float wx = sum[1], wxx = sum[2], wy = sum[3], wxy = sum[4], wyy = sum[5];
  mean[0] = p * wx + q * wy;
  mean[1] = q * wx + s * wy;
  // dL/dSigma = 1/2 P W P with W the second moments of w
  const float a0 = p * wxx + q * wxy, a1 = p * wxy + q * wyy, b0 = q * wxx + s * wxy, b1 = q * wxy + s * wyy;
  out[0] = 0.5f * (a0 * p + a1 * q);
  out[1] = 0.5f * ((a0 * q + a1 * s) + (b0 * p + b1 * q));
  out[2] = 0.5f * (b0 * q + b1 * s);
}

}  // namespace
}  // namespace sgi
