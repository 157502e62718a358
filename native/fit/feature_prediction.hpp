// What MLP_p says of an attribute means: its mean, step and scale, and the way back.
#pragma once
#include "base/elementary.hpp"
#include "base/vector.hpp"
#include "fit/seed_limits.hpp"
#include "model/steps.hpp"
#include "model/value_bits.hpp"

namespace sgi {
namespace {

// Of LANES seeds, from MLP_p's outputs: a mean in base steps, a scale and a refinement of the step in octaves.
struct FeatureUnit {
  vf mean, step, scale;
  float base;
  vf raw_scale;
  vi step_is_free, scale_is_free, output_is_free, refine_is_free;  // not at a bound: gradients pass

  FeatureUnit(float base_step, vf said_mean, vf said_scale, vf said_refine) : base(base_step) {
    const vf wanted = base * exp2v(clampv(said_refine, octaves(kRefineLimit)));
    refine_is_free = absv(said_refine) < octaves(kRefineLimit);
    step_is_free = (wanted > kMinStep) & (wanted < kGreatestStep);
    step = minv(maxv(wanted, vf{} + kMinStep), vf{} + kGreatestStep);
    mean = said_mean * base;
    output_is_free = absv(said_scale) < float(kOctaveLimit);
    raw_scale = exp2v(clampv(said_scale, float(kOctaveLimit))) * base;
    scale_is_free = raw_scale >= step * kMinScale;
    scale = maxv(raw_scale, step * kMinScale);
  }

  // Gradient of the step in the refinement.
  vf step_slope() const { return select(step_is_free & refine_is_free, step * kLn2, vf{}); }

  // Gradients of MLP_p's scale and refinement, from those of scale and step.
  struct Slopes {
    vf scale, refine;
  };
  Slopes descend(vf of_scale, vf of_step) const {
    of_step += select(scale_is_free, vf{}, of_scale * kMinScale);
    return {select(scale_is_free & output_is_free, of_scale * raw_scale * kLn2, vf{}), of_step * step_slope()};
  }
};

}  // namespace
}  // namespace sgi
