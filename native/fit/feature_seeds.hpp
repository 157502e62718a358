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

// What one seed sees of one resolution of H, in rows `pitch` apart. WIDTH: entry_features, 0 for any.
template <int WIDTH>
inline void see_signs(const FeatureState &s, int64_t seed, int resolution, float *rows, int64_t pitch) {
  const int width = WIDTH ? WIDTH : s.entry_features;
  const int32_t *entry = s.entry + (seed * s.resolutions + resolution) * 4;
  const float *weight = s.weight + (seed * s.resolutions + resolution) * 4;
  constexpr int kTogether = WIDTH ? WIDTH : 1;
  for (int f = 0; f < width; f += kTogether) {
    float sum[kTogether] = {};
    for (int c = 0; c < 4; ++c)
      for (int i = 0; i < kTogether; ++i) sum[i] += weight[c] * float(s.signs[int64_t(entry[c]) * width + f + i]);
    for (int i = 0; i < kTogether; ++i) rows[(f + i) * pitch] = sum[i];
  }
}

// What MLP_p says of an attribute.
inline FeatureUnit unit_of(const FeatureState &s, const SeedRows &said, int attribute) {
  return FeatureUnit(s.steps[attribute], said.get(attribute), said.get(s.attributes() + attribute),
                     said.get(2 * s.attributes() + s.group_of(attribute)));
}

// What bits leave for their way back. Of each attribute, the gradients of one bit in its drawn value and in the scale
// that MLP_p says, and that of its drawn value in the refinement of its step; gradients of one bit in the refinements.
struct BitRows {
  SeedRows values, scales, noise, refine;

  BitRows(const FeatureModel &m, const SeedRows &rows)
      : values(rows), scales(rows.from(m.attributes())), noise(rows.from(2 * m.attributes())),
        refine(rows.from(3 * m.attributes())) {}
};

// Attributes as drawn, of the seeds from `first` on; returns their bits. `left`: written where bits count.
inline vf draw_values(const FeatureState &s, int64_t first, const SeedRows &values, const SeedRows &said,
                      const SeedRows &drawn, const BitRows &left) {
  vf bits{}, refine[kRefinements] = {};
  for (int j = 0; j < s.attributes(); ++j) {
    vf value = values.get(j);
    if (s.rounding == Rounding::kNoise) {
      const vf spread = noise(s.key, s.mirror, j, first);
      if (s.priced) {
        const FeatureUnit unit = unit_of(s, said, j);
        value += unit.step * spread;
        const Bits<vf> b = gaussian_bits(value - unit.mean, unit.step, unit.scale);
        bits += b.bits;
        const FeatureUnit::Slopes up = unit.descend(b.scale, b.step);
        left.values.set(j, b.deviation);
        left.scales.set(j, up.scale);
        left.noise.set(j, spread * unit.step_slope());
        refine[s.group_of(j)] += up.refine;
      } else {
        value += s.steps[j] * spread;
      }
    }
    drawn.set(j, value);
  }
  if (s.priced)
    for (int i = 0; i < kRefinements; ++i) left.refine.set(i, refine[i]);
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

// Means [2 K] and covariances [3 K] of the Gaussians.
inline void place_gaussians(const FeatureState &s, const SeedPlace &place, const SeedRows &means,
                            const SeedRows &covariances) {
  vf centre[2];
  for (int axis = 0; axis < 2; ++axis) centre[axis] = place.block.gather(s.half_pixels, 2, axis) * 0.5f;
  for (int k = 0; k < s.per_seed; ++k) {
    const RotatedCovariance<vf> covariance = place.covariance(k);
    covariances.set(3 * k, covariance.xx() + float(kMinVariance));
    covariances.set(3 * k + 1, covariance.xy());
    covariances.set(3 * k + 2, covariance.yy() + float(kMinVariance));
    for (int axis = 0; axis < 2; ++axis) {
      const vf offset = place.drawn.get(s.first_offset() + 2 * k + axis) * place.scales[axis];
      means.set(2 * k + axis, s.scale * (centre[axis] + offset));
    }
  }
}

// From gradients of means and covariances to those of what MLP_Sigma says and, in `slopes`, of scales and offsets as
// drawn.
inline void descend_gaussians(const FeatureState &s, const SeedPlace &place, const SeedRows &means,
                              const SeedRows &covariances, const SeedRows &up_shapes, const SeedRows &slopes) {
  vf scales[kSeedScales] = {};
  for (int k = 0; k < s.per_seed; ++k) {
    vf shape[3], reaches[2];
    const auto up = [&](int i) { return covariances.get(3 * k + i); };
    place.covariance(k).descend(up(0), up(1), up(2), shape, reaches);
    for (int i = 0; i < 3; ++i) up_shapes.set(3 * k + i, shape[i]);
    for (int axis = 0; axis < 2; ++axis) {
      const int row = s.first_offset() + 2 * k + axis;
      const vf mean = s.scale * means.get(2 * k + axis);
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
inline void price_values(const FeatureState &s, int64_t first, float one, const BitRows &left, const SeedRows &slopes,
                         const SeedRows &up_said) {
  const int attributes = s.attributes();
  const Block block(first, s.count);
  const vf chance = noise(s.key, s.mirror, attributes, first) + 0.5f;
  const vf bit = select(chance < s.share, block.live * one, vf{});
  vf refine[kRefinements];
  for (int i = 0; i < kRefinements; ++i) refine[i] = bit * left.refine.get(i);
  for (int j = 0; j < attributes; ++j) {
    const vf slope = bit * left.values.get(j), value = slopes.get(j) + slope;
    slopes.set(j, value);
    up_said.set(j, slope * -s.steps[j]);
    up_said.set(attributes + j, bit * left.scales.get(j));
    refine[s.group_of(j)] += value * left.noise.get(j);
  }
  for (int i = 0; i < kRefinements; ++i) up_said.set(2 * attributes + i, refine[i]);
}

// Gradients of the logarithms of s_o and s_a from those of themselves.
inline void descend_scales(const FeatureState &s, const SeedRows &values, const SeedRows &slopes) {
  for (int j = s.first_scale(); j < s.first_offset(); ++j) slopes.set(j, slopes.get(j) * values.get(j));
}

}  // namespace
}  // namespace sgi
