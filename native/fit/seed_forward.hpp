// A block of seeds from attributes to Gaussians and bits.
#pragma once
#include "fit/noise.hpp"
#include "fit/seed_inputs.hpp"
#include "fit/seed_prediction.hpp"
#include "model/gaussian_block.hpp"
#include "model/value_bits.hpp"

namespace sgi {
namespace {

// Draws or rounds, writes Gaussians and `decoded`; returns the bits of each seed, 0 for what is no seed.
inline vf forward_block(const SeedState &s, const Block &block, const SeedGaussians &out) {
  float *decoded = s.decoded + block.number() * s.attributes() * LANES;
  vf sum{}, loudness{}, inputs[kCommonInputs + kMaxOwnInputs];
  if (s.predicts) common_inputs(s, block, inputs);
  for (int g = 0; g < kGroups; ++g) {
    const int size = s.group_size(g), start = s.group_start(g);
    Unit units[3];
    if (s.predicts) {
      vf outputs[kMaxOutputs];
      own_inputs(s, decoded, g, loudness, inputs + kCommonInputs);
      evaluate(s, g, inputs, outputs);
      units_of(s, block, g, outputs, loudness, units);
      keep_units(units, g, kept_units(s, block, g));
    } else if (s.rounding != Rounding::kNone) {
      load_units(kept_units(s, block, g), g, units);
    }
    for (int j = 0; j < size; ++j) {
      vf value = block.gather(s.value[g], size, j);
      if (s.rounding != Rounding::kNone) {
        const Unit &unit = units[unit_of(s, g, j)];
        value = s.rounding == Rounding::kNoise ? value + unit.step * noise(s.key, s.mirror, start + j, block.first)
                                               : rounded(value, unit);
        sum += laplace_bits(value - unit.mean, unit.step, unit.scale).bits;
      }
      store(decoded + (start + j) * LANES, value);
    }
    if (g == 0 && s.predicts) loudness = loudness_of(s, decoded);
  }
  write_gaussians(s, s.seeds, block, [&](int column) { return load(decoded + column * LANES); }, out);
  return sum * block.live;
}

}  // namespace
}  // namespace sgi
