// The Gaussians of a block of seeds, one in each lane.
#pragma once
#include "base/lanes.hpp"
#include "model/gaussians.hpp"
#include "model/seed_gaussians.hpp"

namespace sgi {
namespace {

// Sides of the cells, pixels.
inline vf cells_of(const SeedsView &seeds, const Block &block) {
  vf v;
  for (int i = 0; i < LANES; ++i) set_lane(v, i, float(1 << seeds.log_size[block.row[i]]));
  return v;
}

// `value`(column) gives an attribute of all lanes.
template <class Value>
inline Shape<vf> shape_of(const SeedModel &model, Value value) {
  const int column = model.group_start(kShape);
  return {value(column), value(column + 1), value(column + 2)};
}

template <class Value>
inline void write_gaussians(const SeedModel &m, const SeedsView &seeds, const Block &block, Value value,
                            const SeedGaussians &out) {
  const vf cell = cells_of(seeds, block), area = cell * cell;
  for (int c = 0; c < m.channels; ++c) block.scatter(value(c), out.colours, m.channels, c);
  const Covariance<vf> covariance(shape_of(m, value), area);
  block.scatter(covariance.xx(), out.covariances, 3, 0);
  block.scatter(covariance.xy(), out.covariances, 3, 1);
  block.scatter(covariance.yy(), out.covariances, 3, 2);
  for (int axis = 0; axis < 2; ++axis) {
    const vf centre = block.gather(seeds.half_pixels, 2, axis) * 0.5f;
    block.scatter(centre + cell * value(m.group_start(kOffset) + axis), out.means, 2, axis);
  }
}

}  // namespace
}  // namespace sgi
