// From gradients of a group's decoded values to those of its values and of the steps.
#pragma once
#include "fit/noise.hpp"
#include "fit/seed_prediction.hpp"
#include "model/value_bits.hpp"

namespace sgi {
namespace {

// One group of a block, exact: gradients of values are those of what is decoded.
inline void pass_group(const SeedState &s, const Block &block, int group, const float *grad, const SeedGradients &g) {
  const int size = s.group_size(group), start = s.group_start(group);
  for (int j = 0; j < size; ++j) block.scatter(load(grad + (start + j) * LANES), g.value[group], size, j);
}

// The same under noise or rounded; rows of `sums` are those of the steps.
template <class Sums>
inline void descend_group(const SeedState &s, const Block &block, int group, vf loudness, const float *decoded,
                          const float *grad, const SeedGradients &g, const Sums &sums) {
  const int size = s.group_size(group), start = s.group_start(group);
  Unit units[3];
  load_units(kept_units(s, block, group), group, units);
  vf mean[3] = {}, scale[3] = {}, step[3] = {};
  for (int j = 0; j < size; ++j) {
    const int i = unit_of(s, group, j);
    const Unit &unit = units[i];
    const vf above = load(grad + (start + j) * LANES) * block.live;
    const Bits<vf> b = laplace_bits(load(decoded + (start + j) * LANES) - unit.mean, unit.step, unit.scale);
    const vf price = g.lmbda * block.live, slope = price * b.deviation;
    block.scatter(above + slope, g.value[group], size, j);
    mean[i] -= slope;
    scale[i] += price * b.scale;
    if (s.rounding == Rounding::kNoise)
      step[i] += price * b.step + (above + slope) * noise(s.key, s.mirror, start + j, block.first);
  }
  vf gamma{};
  for (int i = 0; i < kGroupUnits[group]; ++i) {
    const Unit &unit = units[i];
    const vi step_is_free = (unit.step > kMinStep) & (unit.step < kGreatestStep);  // bounds pass no gradients
    const vi scale_is_free = unit.scale > unit.step * kMinScale;
    step[i] += select(scale_is_free, vf{}, scale[i] * kMinScale);
    const vf log_step = select(step_is_free, step[i] * unit.step * kLn2, vf{});
    const vf log_base =
        log_step + mean[i] * unit.mean * kLn2 + select(scale_is_free, scale[i] * unit.scale * kLn2, vf{});
    for (int l = 0; l < LANES; ++l)
      sums.add_to_lane((kFirstUnit[group] + i) * kLevels + level_of(s.seeds.log_size[block.row[l]]), l,
                       lane(log_base, l));
    gamma -= log_step * above_zero(group, loudness);
  }
  if (group) sums.add(kUnits * kLevels + group - 1, gamma);
}

}  // namespace
}  // namespace sgi
