// The step of LANES seeds that hold features, but for their networks: values as drawn and their bits, Gaussians, and
// the way back. A GPU's kernels are these, too, with a seed for a thread.
#pragma once
#include "base/elementary.hpp"
#include "base/lanes.hpp"
#include "fit/feature_kernel.hpp"
#include "fit/feature_prediction.hpp"
#include "fit/noise.hpp"
#include "model/rotated_gaussian.hpp"

namespace sgi {
namespace {

// Rows of floats, `pitch` apart, at the columns of LANES seeds.
struct SeedRows {
  float *at;
  int64_t pitch;

  vf get(int row) const { return load(at + row * pitch); }
  void set(int row, vf value) const { store(at + row * pitch, value); }
  SeedRows from(int row) const { return {at + row * pitch, pitch}; }
};

// A value as it is coded, from what trains: s_o and s_a themselves, of which the logarithms train.
inline vf coded_value(const FeatureModel &m, int attribute, vf trained) {
  return attribute < m.first_scale() || attribute >= m.first_offset() ? trained : exp2v(trained * kLog2e);
}

// Input `feature` of MLP_p from one resolution of H, of one seed.
inline float hash_input(const FeatureState &s, int64_t seed, int resolution, int feature) {
  const int32_t *entry = s.entry + (seed * s.resolutions + resolution) * 4;
  const float *weight = s.weight + (seed * s.resolutions + resolution) * 4;
  float sum = 0;
  for (int c = 0; c < 4; ++c) sum += weight[c] * s.signs[int64_t(entry[c]) * s.entry_features + feature];
  return sum;
}

// What MLP_p says of an attribute.
inline FeatureUnit unit_of(const FeatureState &s, const SeedRows &said, int attribute) {
  return FeatureUnit(s.steps[attribute], said.get(attribute), said.get(s.attributes() + attribute),
                     said.get(2 * s.attributes() + s.group_of(attribute)));
}

// Attributes as drawn, of the seeds from `first` on; returns their bits.
inline vf draw_values(const FeatureState &s, int64_t first, const SeedRows &values, const SeedRows &said,
                      const SeedRows &drawn) {
  vf bits{};
  for (int j = 0; j < s.attributes(); ++j) {
    vf value = values.get(j);
    if (s.rounding == Rounding::kNoise) {
      const vf spread = noise(s.key, s.mirror, j, first);
      if (s.priced) {
        const FeatureUnit unit = unit_of(s, said, j);
        value += unit.step * spread;
        bits += gaussian_bits(value - unit.mean, unit.step, unit.scale).bits;
      } else {
        value += s.steps[j] * spread;
      }
    }
    drawn.set(j, value);
  }
  return bits;
}

// Seeds on their way to Gaussians. shapes: what MLP_Sigma says.
struct SeedPlace {
  Block block;
  SeedRows drawn, shapes;
  vf scales[kSeedScales];
  float scale;

  SeedPlace(const FeatureState &s, int64_t first, const SeedRows &as_drawn, const SeedRows &said_shapes)
      : block(first, s.count), drawn(as_drawn), shapes(said_shapes), scale(s.scale) {
    for (int i = 0; i < kSeedScales; ++i) scales[i] = maxv(drawn.get(s.first_scale() + i), vf{});
  }
  RotatedCovariance<vf> covariance(int k) const {
    vf shape[3];
    for (int i = 0; i < 3; ++i) shape[i] = shapes.get(3 * k + i);
    return RotatedCovariance<vf>(shape, scale * scales[2], scale * scales[3]);
  }
};

// colours: what MLP_c says.
inline void write_gaussians(const FeatureState &s, const SeedPlace &place, const SeedRows &colours,
                            const SeedGaussians &out) {
  const Block &block = place.block;
  for (int i = 0; i < s.colours(); ++i) block.scatter(colours.get(i), out.colours, s.colours(), i);
  for (int k = 0; k < s.per_seed; ++k) {
    const RotatedCovariance<vf> covariance = place.covariance(k);
    const int width = 3 * s.per_seed;
    block.scatter(covariance.xx() + float(kMinVariance), out.covariances, width, 3 * k);
    block.scatter(covariance.xy(), out.covariances, width, 3 * k + 1);
    block.scatter(covariance.yy() + float(kMinVariance), out.covariances, width, 3 * k + 2);
    for (int axis = 0; axis < 2; ++axis) {
      const vf offset = place.drawn.get(s.first_offset() + 2 * k + axis) * place.scales[axis];
      const vf centre = block.gather(s.half_pixels, 2, axis) * 0.5f;
      block.scatter(s.scale * (centre + offset), out.means, 2 * s.per_seed, 2 * k + axis);
    }
  }
}

// From gradients of Gaussians to those of the decoders' outputs and, in `slopes`, of scales and offsets as drawn; none
// of what is no seed.
inline void read_slopes(const FeatureState &s, const SeedPlace &place, const FeatureGradients &g,
                        const SeedRows &up_colours, const SeedRows &up_shapes, const SeedRows &slopes) {
  const Block &block = place.block;
  for (int i = 0; i < s.colours(); ++i) up_colours.set(i, block.gather(g.colours, s.colours(), i) * block.live);
  vf scales[kSeedScales] = {};
  for (int k = 0; k < s.per_seed; ++k) {
    vf shape[3], reaches[2];
    const auto up = [&](int i) { return block.gather(g.covariances, 3 * s.per_seed, 3 * k + i) * block.live; };
    place.covariance(k).descend(up(0), up(1), up(2), shape, reaches);
    for (int i = 0; i < 3; ++i) up_shapes.set(3 * k + i, shape[i]);
    for (int axis = 0; axis < 2; ++axis) {
      const int row = s.first_offset() + 2 * k + axis;
      const vf mean = s.scale * block.live * block.gather(g.means, 2 * s.per_seed, 2 * k + axis);
      slopes.set(row, mean * place.scales[axis]);
      scales[axis] += mean * place.drawn.get(row);
      scales[2 + axis] += s.scale * reaches[axis];
    }
  }
  for (int i = 0; i < kSeedScales; ++i) {
    const int row = s.first_scale() + i;
    slopes.set(row, select(place.drawn.get(row) > 0.0f, scales[i], vf{}));
  }
}

// From gradients of the drawn values to those of the values, with those of their bits, which cost `one`, and of what
// MLP_p said.
inline void price_values(const FeatureState &s, int64_t first, float one, const SeedRows &drawn, const SeedRows &said,
                         const SeedRows &slopes, const SeedRows &up_said) {
  const int attributes = s.attributes();
  const Block block(first, s.count);
  const vf chance = noise(s.key, s.mirror, attributes, first) + 0.5f;
  const vf bit = select(chance < s.share, block.live * one, vf{});
  vf refine[kRefinements] = {};
  for (int j = 0; j < attributes; ++j) {
    const FeatureUnit unit = unit_of(s, said, j);
    const Bits<vf> b = gaussian_bits(drawn.get(j) - unit.mean, unit.step, unit.scale);
    const vf slope = bit * b.deviation, value = slopes.get(j) + slope;
    slopes.set(j, value);
    const vf spread = noise(s.key, s.mirror, j, first);
    const FeatureUnit::Slopes up = unit.descend(-slope, bit * b.scale, bit * b.step + spread * value);
    up_said.set(j, up.mean);
    up_said.set(attributes + j, up.scale);
    refine[s.group_of(j)] += up.refine;
  }
  for (int i = 0; i < kRefinements; ++i) up_said.set(2 * attributes + i, refine[i]);
}

// Gradients of the logarithms of s_o and s_a from those of themselves.
inline void descend_scales(const FeatureState &s, const SeedRows &values, const SeedRows &slopes) {
  for (int j = s.first_scale(); j < s.first_offset(); ++j) slopes.set(j, slopes.get(j) * values.get(j));
}

}  // namespace
}  // namespace sgi
