// Gradients from Gaussians back to a block's attributes.
#pragma once
#include "fit/seed_block.hpp"
#include "model/gaussian_block.hpp"

namespace sgi {
namespace {

// Gradients of the decoded attributes through the Gaussians, rows of LANES floats.
inline void read_gradients(const SeedState &s, const Block &block, const float *decoded, const SeedGradients &g,
                           float *out) {
  const int channels = s.channels;
  const auto value = [&](int column) { return load(decoded + column * LANES); };
  const vf cell = cells_of(s.seeds, block), area = cell * cell;
  for (int c = 0; c < channels; ++c) store(out + c * LANES, block.gather(g.colours, channels, c));
  const auto up = [&](int column) { return block.gather(g.covariances, 3, column); };
  const Shape<vf> shape = shape_gradient(shape_of(s, value), area, up(0), up(1), up(2));
  float *row = out + s.group_start(kShape) * LANES;
  store(row, shape.a);
  store(row + LANES, shape.b);
  store(row + 2 * LANES, shape.c);
  for (int axis = 0; axis < 2; ++axis)
    store(out + (s.group_start(kOffset) + axis) * LANES, cell * block.gather(g.means, 2, axis));
}

}  // namespace
}  // namespace sgi
