// What MLP_p says of a block of seeds, and what that means in means, steps and scales.
#pragma once
#include "base/elementary.hpp"
#include "fit/seed_block.hpp"
#include "fit/seed_limits.hpp"

namespace sgi {
namespace {

// MLP_p at one coding step: hidden values into `scratch`, outputs (means, scales, refinement) into `out`.
template <int OWN, int OUTPUTS>
inline void evaluate_step(const SeedState &s, const Block &block, int group, const vf *own, float *hidden, vf *out) {
  const float *product = s.product + (block.number() * kGroups + group) * s.hidden * LANES;
  const float *b1 = s.rest[group], *w2 = b1 + s.hidden, *b2 = w2 + OUTPUTS * s.hidden;
  const float *w1 = s.first[group] + kCommonInputs;
  constexpr int kWidth = kCommonInputs + OWN;
  for (int o = 0; o < OUTPUTS; ++o) out[o] = vf{} + b2[o];
  for (int h = 0; h < s.hidden; ++h) {
    vf x = load(product + h * LANES) + b1[h];
#pragma GCC unroll 12
    for (int c = 0; c < OWN; ++c) x += own[c] * w1[h * kWidth + c];
    x = maxv(x, vf{});
    store(hidden + h * LANES, x);
#pragma GCC unroll 7
    for (int o = 0; o < OUTPUTS; ++o) out[o] += x * w2[o * s.hidden + h];
  }
}

inline void evaluate(const SeedState &s, const Block &block, int group, const vf *own, float *hidden, vf *out) {
  switch (group) {
    case 0: return evaluate_step<own_input_count(0), outputs_of(0)>(s, block, 0, own, hidden, out);
    case 1: return evaluate_step<own_input_count(1), outputs_of(1)>(s, block, 1, own, hidden, out);
    default: return evaluate_step<own_input_count(2), outputs_of(2)>(s, block, 2, own, hidden, out);
  }
}

// Mean, scale and step of one prediction; the rest is only there when MLP_p has just said it.
struct Unit {
  vf mean, step, scale, base_step, raw_scale;
  vi step_is_free, scale_is_free;  // not at a bound: gradients pass
  vi output_is_free;               // the same for the scale that MLP_p says
};

struct Units {
  Unit unit[3];
  vf refine, loudness;  // refinement before its bound, and how far the amplitude lies above AMPLITUDE_ZERO
};

inline Units units_of(const SeedState &s, const Block &block, int group, const vf *out, vf loudness) {
  const int count = kGroupUnits[group];
  Units u;
  u.refine = out[2 * count];
  u.loudness = group ? loudness - octaves(kAmplitudeZero) : vf{};
  const float gamma = group ? s.gamma[group - 1] : 0.0f;
  for (int i = 0; i < count; ++i) {
    Unit &v = u.unit[i];
    vf log_base{};
    for (int l = 0; l < LANES; ++l)
      set_lane(log_base, l, s.base[(kFirstUnit[group] + i) * kLevels + level_of(s.seeds.log_size[block.row[l]])]);
    v.base_step = exp2v(log_base);
    const vf step = exp2v(refined_step(log_base, fall_with(gamma, u.loudness), u.refine));
    v.step_is_free = (step > kMinStep) & (step < kGreatestStep);
    v.step = minv(maxv(step, vf{} + kMinStep), vf{} + kGreatestStep);
    v.mean = out[i] * v.base_step;
    v.output_is_free = absv(out[count + i]) < float(kOctaveLimit);
    v.raw_scale = exp2v(clampv(out[count + i], kOctaveLimit)) * v.base_step;
    v.scale_is_free = v.raw_scale >= v.step * kMinScale;
    v.scale = maxv(v.raw_scale, v.step * kMinScale);
  }
  return u;
}

// Predictions of a group that outlive their step.
inline float *kept_units(const SeedState &s, const Block &block, int group) {
  return s.kept + (block.number() * kUnits + kFirstUnit[group]) * 3 * LANES;
}

inline void keep_units(const Units &u, int group, float *to) {
  for (int i = 0; i < kGroupUnits[group]; ++i, to += 3 * LANES) {
    store(to, u.unit[i].mean);
    store(to + LANES, u.unit[i].step);
    store(to + 2 * LANES, u.unit[i].scale);
  }
}

inline void load_units(const float *from, int group, Units &u) {
  for (int i = 0; i < kGroupUnits[group]; ++i, from += 3 * LANES) {
    u.unit[i].mean = load(from);
    u.unit[i].step = load(from + LANES);
    u.unit[i].scale = load(from + 2 * LANES);
  }
}

inline vf rounded(vf value, const Unit &u) {
  const vf position = (value - u.mean) / u.step;
  const vf lean = minv(float(kDeadZone) * u.step / u.scale, vf{} + float(kDeadZoneLimit));
  return u.mean + u.step * signv(position) * floorv(maxv(absv(position) + 0.5f - lean, vf{}));
}

}  // namespace
}  // namespace sgi
