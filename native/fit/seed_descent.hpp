// From gradients of a group's decoded values to those of its values and of what MLP_p says.
#pragma once
#include "fit/noise.hpp"
#include "fit/seed_prediction.hpp"
#include "model/value_bits.hpp"

namespace sgi {
namespace {

// One group of a block: gradients of its values, and of MLP_p's outputs `up`.
template <class Sums>
inline void descend_group(const SeedState &s, const Block &block, int group, const Units &u, const float *decoded,
                          const float *grad, const SeedGradients &g, vf *up, const Sums &sums) {
  const int size = s.group_size(group), start = s.group_start(group), count = kGroupUnits[group];
  vf mean[3] = {}, scale[3] = {}, step[3] = {};
  for (int j = 0; j < size; ++j) {
    const int i = unit_of(s, group, j);
    const Unit &unit = u.unit[i];
    const vf above = load(grad + (start + j) * LANES) * block.live;
    const Bits<vf> b = laplace_bits(load(decoded + (start + j) * LANES) - unit.mean, unit.step, unit.scale);
    const vf price = g.lmbda * block.live, slope = price * b.deviation;
    block.scatter(above + slope, g.value[group], size, j);
    mean[i] -= slope;
    scale[i] += price * b.scale;
    if (s.rounding == Rounding::kNoise)
      step[i] += price * b.step + (above + slope) * noise(s.key, s.mirror, start + j, block.first);
  }
  vf refine{}, gamma{};
  for (int i = 0; i < count; ++i) {
    const Unit &unit = u.unit[i];
    step[i] += select(unit.scale_is_free, vf{}, scale[i] * kMinScale);
    const vf raw = select(unit.scale_is_free, scale[i] * unit.raw_scale * kLn2, vf{});
    const vf log_step = select(unit.step_is_free, step[i] * unit.step * kLn2, vf{});
    const vf log_base = log_step + mean[i] * unit.mean * kLn2 + raw;
    for (int l = 0; l < LANES; ++l)
      sums.add_to_lane(sums.base + (kFirstUnit[group] + i) * kLevels + level_of(s.seeds.log_size[block.row[l]]), l,
                       lane(log_base, l));
    refine += log_step;
    gamma -= log_step * u.loudness;
    up[i] = mean[i] * unit.base_step;
    up[count + i] = select(unit.output_is_free, raw, vf{});
  }
  up[2 * count] = select(absv(u.refine) < octaves(kRefineLimit), refine, vf{});
  if (group) sums.add(sums.gamma + group - 1, gamma);
}

// The same where MLP_p's predictions are constants.
inline void descend_values(const SeedState &s, const Block &block, int group, const float *decoded, const float *grad,
                           const SeedGradients &g) {
  const int size = s.group_size(group), start = s.group_start(group);
  Units u;
  if (s.rounding != Rounding::kNone) load_units(kept_units(s, block, group), group, u);
  for (int j = 0; j < size; ++j) {
    vf slope = load(grad + (start + j) * LANES);
    if (s.rounding != Rounding::kNone) {
      const Unit &unit = u.unit[unit_of(s, group, j)];
      const vf value = load(decoded + (start + j) * LANES);
      slope += g.lmbda * laplace_bits(value - unit.mean, unit.step, unit.scale).deviation;
    }
    block.scatter(slope, g.value[group], size, j);
  }
}

}  // namespace
}  // namespace sgi
