// What MLP_p says of a block of seeds, and what that means in means, steps and scales.
#pragma once
#include "base/elementary.hpp"
#include "fit/seed_block.hpp"
#include "fit/seed_limits.hpp"

namespace sgi {
namespace {

// MLP_p at one coding step from kCommonInputs + OWN inputs: means, scales and the refinement into `out`.
template <int OWN, int OUTPUTS>
inline void evaluate_step(const SeedState &s, int group, const vf *inputs, vf *out) {
  constexpr int kWidth = kCommonInputs + OWN, kAtOnce = 4;
  const float *b1 = s.rest[group], *w2 = b1 + s.hidden, *b2 = w2 + OUTPUTS * s.hidden;
  for (int o = 0; o < OUTPUTS; ++o) out[o] = vf{} + b2[o];
  for (int h = 0; h < s.hidden; h += kAtOnce) {
    const int rows = s.hidden - h < kAtOnce ? s.hidden - h : kAtOnce;
    vf x[kAtOnce];
    const float *w1[kAtOnce];
    for (int i = 0; i < kAtOnce; ++i) {
      const int row = h + (i < rows ? i : rows - 1);
      x[i] = vf{} + b1[row], w1[i] = s.first[group] + row * kWidth;
    }
    for (int c = 0; c < kWidth; ++c)
      for (int i = 0; i < kAtOnce; ++i) x[i] += inputs[c] * w1[i][c];
    for (int i = 0; i < rows; ++i) {
      x[i] = maxv(x[i], vf{});
#pragma GCC unroll 7
      for (int o = 0; o < OUTPUTS; ++o) out[o] += x[i] * w2[o * s.hidden + h + i];
    }
  }
}

inline void evaluate(const SeedState &s, int group, const vf *inputs, vf *out) {
  switch (group) {
    case 0: return evaluate_step<own_input_count(0), outputs_of(0)>(s, 0, inputs, out);
    case 1: return evaluate_step<own_input_count(1), outputs_of(1)>(s, 1, inputs, out);
    default: return evaluate_step<own_input_count(2), outputs_of(2)>(s, 2, inputs, out);
  }
}

// One prediction.
struct Unit {
  vf mean, step, scale;
};

// How far the amplitude lies above that at which steps are those of the plan, octaves; 0 for colours.
inline vf above_zero(int group, vf loudness) { return group ? loudness - octaves(kAmplitudeZero) : vf{}; }

inline void units_of(const SeedState &s, const Block &block, int group, const vf *out, vf loudness, Unit *unit) {
  const int count = kGroupUnits[group];
  const vf fall = fall_with(group ? s.gamma[group - 1] : 0.0f, above_zero(group, loudness));
  for (int i = 0; i < count; ++i) {
    vf log_base{};
    for (int l = 0; l < LANES; ++l)
      set_lane(log_base, l, s.base[(kFirstUnit[group] + i) * kLevels + level_of(s.seeds.log_size[block.row[l]])]);
    const vf base_step = exp2v(log_base), step = exp2v(refined_step(log_base, fall, out[2 * count]));
    unit[i].mean = out[i] * base_step;
    unit[i].step = minv(maxv(step, vf{} + kMinStep), vf{} + kGreatestStep);
    const vf scale = exp2v(clampv(out[count + i], kOctaveLimit)) * base_step;
    unit[i].scale = maxv(scale, unit[i].step * kMinScale);
  }
}

// Predictions of a group that outlive their step.
inline float *kept_units(const SeedState &s, const Block &block, int group) {
  return s.kept + (block.number() * kUnits + kFirstUnit[group]) * 3 * LANES;
}

inline void keep_units(const Unit *unit, int group, float *to) {
  for (int i = 0; i < kGroupUnits[group]; ++i, to += 3 * LANES) {
    store(to, unit[i].mean);
    store(to + LANES, unit[i].step);
    store(to + 2 * LANES, unit[i].scale);
  }
}

inline void load_units(const float *from, int group, Unit *unit) {
  for (int i = 0; i < kGroupUnits[group]; ++i, from += 3 * LANES)
    unit[i] = {load(from), load(from + LANES), load(from + 2 * LANES)};
}

inline vf rounded(vf value, const Unit &u) {
  const vf position = (value - u.mean) / u.step;
  const vf lean = minv(float(kDeadZone) * u.step / u.scale, vf{} + float(kDeadZoneLimit));
  return u.mean + u.step * signv(position) * floorv(maxv(absv(position) + 0.5f - lean, vf{}));
}

}  // namespace
}  // namespace sgi
