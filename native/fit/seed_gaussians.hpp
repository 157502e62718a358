// From a block's attributes to Gaussians, and gradients back.
#pragma once
#include "fit/seed_block.hpp"

namespace sgi {
namespace {

inline void write_gaussians(const SeedState &s, const Block &block, const float *decoded, const SeedGaussians &out) {
  const int k_count = s.per_seed, channels = s.channels;
  const vf cell = block.gather(s.cell, 1, 0), area = cell * cell;
  for (int k = 0; k < k_count; ++k) {
    const float *colour = decoded + k * channels * LANES;
    for (int c = 0; c < channels; ++c) {
      vf sum{};
      for (int j = 0; j < channels; ++j) sum += load(colour + j * LANES) * s.opponent[j * channels + c];
      block.scatter(sum, out.colours, k_count * channels, k * channels + c);
    }
    const float *shape = decoded + (s.group_start(1) + 3 * k) * LANES;
    const vf a = clampv(load(shape), kShapeLimit), b = load(shape + LANES), c = load(shape + 2 * LANES);
    const SymmetricExp e = symmetric_exp(a, minv(b * b + c * c, vf{} + kShapeLimit * kShapeLimit));
    block.scatter(area * (e.even + e.odd * b) + kMinVariance, out.covariances, 3 * k_count, 3 * k);
    block.scatter(area * e.odd * c, out.covariances, 3 * k_count, 3 * k + 1);
    block.scatter(area * (e.even - e.odd * b) + kMinVariance, out.covariances, 3 * k_count, 3 * k + 2);
    const float *offset = decoded + (s.group_start(2) + 2 * k) * LANES;
    for (int axis = 0; axis < 2; ++axis)
      block.scatter(block.gather(s.centre, 2, axis) + cell * load(offset + axis * LANES), out.means, 2 * k_count,
                    2 * k + axis);
  }
}

// Gradients of the decoded attributes through the Gaussians, rows of LANES floats.
inline void read_gradients(const SeedState &s, const Block &block, const float *decoded, const SeedGradients &g,
                           float *out) {
  const int k_count = s.per_seed, channels = s.channels;
  const vf cell = block.gather(s.cell, 1, 0), area = cell * cell;
  for (int k = 0; k < k_count; ++k) {
    for (int j = 0; j < channels; ++j) {
      vf sum{};
      for (int c = 0; c < channels; ++c)
        sum += block.gather(g.colours, k_count * channels, k * channels + c) * s.opponent[j * channels + c];
      store(out + (k * channels + j) * LANES, sum);
    }
    const int row = s.group_start(1) + 3 * k;
    const float *shape = decoded + row * LANES;
    const vf raw = load(shape), a = clampv(raw, kShapeLimit), b = load(shape + LANES), c = load(shape + 2 * LANES);
    const vf t = b * b + c * c;
    const SymmetricExp e = symmetric_exp(a, minv(t, vf{} + kShapeLimit * kShapeLimit));
    const vf xx = area * block.gather(g.covariances, 3 * k_count, 3 * k);
    const vf xy = area * block.gather(g.covariances, 3 * k_count, 3 * k + 1);
    const vf yy = area * block.gather(g.covariances, 3 * k_count, 3 * k + 2);
    const vf even = xx + yy, odd = (xx - yy) * b + xy * c;
    const vf along = select(t < kShapeLimit * kShapeLimit, 2.0f * (even * e.odd + odd * e.slope), vf{});
    store(out + row * LANES, select(absv(raw) < kShapeLimit, 2.0f * (even * e.even + odd * e.odd), vf{}));
    store(out + (row + 1) * LANES, (xx - yy) * e.odd + along * b);
    store(out + (row + 2) * LANES, xy * e.odd + along * c);
    for (int axis = 0; axis < 2; ++axis)
      store(out + (s.group_start(2) + 2 * k + axis) * LANES,
            cell * block.gather(g.means, 2 * k_count, 2 * k + axis));
  }
}

}  // namespace
}  // namespace sgi
