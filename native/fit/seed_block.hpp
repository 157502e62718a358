// LANES seeds side by side, and what they tell MLP_p of themselves.
#pragma once
#include "fit/seed_kernel.hpp"
#include "fit/seed_math.hpp"

namespace sgi {
namespace {

// Limits and constants that model/ and fit/sampler.py define.
constexpr float kInputLimit = 128.0f;  // INPUT_LIMIT in units of 2^-INPUT_BITS
constexpr float kColourInput = 16.0f, kLoudnessOffset = 6.0f, kAmplitudeZero = -20.0f / 6.0f;
constexpr float kLeastStep = 0x1p-16f, kGreatestStep = 2.0f, kLeastScale = 0x1p-4f;
constexpr float kRefineLimit = 4.0f, kScaleLimit = 12.0f;
constexpr float kDeadZone = 0.118f, kDeadZoneLimit = 0.3f;
constexpr float kMinVariance = 0.05f, kShapeLimit = 12.0f;
constexpr float kNeighbourWeights[kMostNeighbours] = {4, 3, 3, 2, 2, 2};
constexpr int kMostOutputs = 7, kMostOwn = 12;

// Memory of one run: what blocks write anew, and the sums over seeds as vectors over lanes.
struct Scratch {
  float *hidden, *attributes, *sums;
  Scratch(const SeedState &s, float *memory)
      : hidden(memory), attributes(hidden + kBatch * s.hidden * LANES),
        sums(attributes + kBatch * s.attributes() * LANES) {}
};

// Seeds behind the last stand for the last one and count nothing.
struct Block {
  int64_t first;
  int64_t seed[LANES];
  vf live;

  Block(const SeedState &s, int64_t begin) : first(begin), live() {
    for (int i = 0; i < LANES; ++i) {
      seed[i] = begin + i < s.count ? begin + i : s.count - 1;
      live[i] = begin + i < s.count ? 1.0f : 0.0f;
    }
  }
  vf gather(const float *rows, int width, int column) const {
    vf v;
    for (int i = 0; i < LANES; ++i) v[i] = rows[seed[i] * width + column];
    return v;
  }
  void scatter(vf v, float *rows, int width, int column) const {
    for (int i = 0; i < LANES; ++i)
      if (live[i] != 0.0f) rows[seed[i] * width + column] = v[i];
  }
  int64_t number() const { return first / LANES; }
};

inline int unit_of(const SeedState &s, int group, int column) {
  if (group == 0) return s.channels >= 3 && column % s.channels < 3 ? column % s.channels : 0;
  return column % kGroupUnits[group];
}

// What the colours [K C] and shapes [3 K] of a block say, in inputs' units, from rows of LANES floats.
inline vf loudness_of(const SeedState &s, const float *decoded) {
  vf energy{};
  for (int j = 0; j < s.group_size(0); ++j) energy += load(decoded + j * LANES) * load(decoded + j * LANES);
  return 0.5f * log2v(maxv(energy, vf{} + 0x1p-24f));
}

inline vf mean_of(const SeedState &s, const float *decoded, int group, int column) {
  const int width = group == 0 ? s.channels : 3;
  vf sum{};
  for (int k = 0; k < s.per_seed; ++k) sum += load(decoded + (s.group_start(group) + k * width + column) * LANES);
  return sum / float(s.per_seed);
}

inline vf colour_input(const SeedState &s, const float *decoded, int channel) {
  if (channel > 0 && s.channels < 3) return vf{};
  return clampv(mean_of(s, decoded, 0, channel) * kColourInput, kInputLimit);
}

// Own earlier groups as inputs of MLP_p at coding step `group`; returns how many.
inline int own_inputs(const SeedState &s, const float *decoded, int group, vf loudness, vf *own) {
  if (group == 0) return 0;
  for (int c = 0; c < 3; ++c) {
    own[c] = colour_input(s, decoded, c);
    own[3 + c] = absv(own[c]);
  }
  own[6] = maxv(loudness + kLoudnessOffset, vf{} - kLoudnessOffset);
  if (group == 1) return kOwnInputs[1];
  for (int c = 0; c < 3; ++c) own[7 + c] = clampv(mean_of(s, decoded, 1, c), kInputLimit);
  own[10] = absv(own[8]);
  own[11] = absv(own[9]);
  return kOwnInputs[2];
}

}  // namespace
}  // namespace sgi
