// LANES seeds side by side, and what they tell MLP_p of themselves.
#pragma once
#include "base/lanes.hpp"
#include "fit/seed_kernel.hpp"
#include "model/context_inputs.hpp"

namespace sgi {
namespace {

constexpr float kMinEnergy = 1.0f / (1 << kFractionBits);
constexpr int kMaxOutputs = outputs_of(kColour);

// Memory of one run: what blocks write anew, and the sums over seeds as vectors over lanes.
struct Scratch {
  float *attributes, *sums;
  Scratch(const SeedState &s, float *memory) : attributes(memory), sums(memory + s.attributes() * LANES) {}
};

inline int unit_of(const SeedState &s, int group, int column) {
  if (group == 0) return s.channels >= 3 && column < 3 ? column : 0;
  return column;
}

// The amplitude of the colours [C] of a block in octaves, from rows of LANES floats.
inline vf loudness_of(const SeedState &s, const float *decoded) {
  vf energy{};
  for (int j = 0; j < s.group_size(0); ++j) energy += load(decoded + j * LANES) * load(decoded + j * LANES);
  return 0.5f * log2v(maxv(energy, vf{} + kMinEnergy));
}

// A summary's columns 0 to 2, and 4 to 6.
inline void colour_summary(const SeedState &s, const float *decoded, vf *row) {
  summarise_colour<vf>(s.channels, [&](int j) { return load(decoded + j * LANES); }, row);
}

inline void shape_summary(const SeedState &s, const float *decoded, vf *row) {
  const float *shape = decoded + s.group_start(kShape) * LANES;
  summarise_shape([&](int j) { return load(shape + j * LANES); }, row);
}

// Own earlier groups as inputs of MLP_p at coding step `group`.
inline void own_inputs(const SeedState &s, const float *decoded, int group, vf loudness, vf *own) {
  vf row[kSummary] = {};
  if (group >= kShape) colour_summary(s, decoded, row);
  if (group >= kOffset) shape_summary(s, decoded, row);
  row[3] = loudness_input(loudness);
  own_inputs_of(row, group, own);
}

}  // namespace
}  // namespace sgi
