// What MLP_p sees of all seeds before it runs: summaries, inputs from neighbours, and their products with its first layer.
#pragma once
#include "fit/seed_block.hpp"

namespace sgi {
namespace {

void summarize(const SeedState &s, int64_t begin, int64_t end, float *memory) {
  float *rows = Scratch(s, memory).attributes;
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(s, at);
    for (int g = 0; g < 2; ++g)
      for (int j = 0; j < s.group_size(g); ++j)
        store(rows + (s.group_start(g) + j) * LANES, block.gather(s.value[g], s.group_size(g), j));
    for (int c = 0; c < 3; ++c) block.scatter(colour_input(s, rows, c), s.summary, kSummary, c);
    const vf loudness = loudness_of(s, rows) + kLoudnessOffset;
    block.scatter(maxv(loudness, vf{} - kLoudnessOffset), s.summary, kSummary, 3);
    for (int c = 0; c < 3; ++c) block.scatter(mean_of(s, rows, 1, c), s.summary, kSummary, 4 + c);
  }
}

// Inputs of one seed in the order of model/context.py, in units of one.
inline void inputs_of_seed(const SeedState &s, int64_t seed, float *out) {
  for (int c = 0; c < kCommonInputs; ++c) out[c] = c <= kLevels ? s.level_inputs[seed * (kLevels + 1) + c] : 0.0f;
  float *count = out + kLevels + 1, *weighted = count + 1, *sizes = weighted + kSummary, *level = sizes + 5,
        *nearest = level + 1, *offset = nearest + kSummary;
  const int32_t *others = s.neighbour + seed * s.neighbours;
  constexpr int kSigned[5] = {0, 1, 2, 5, 6};
  for (int rank = 0; rank < s.neighbours; ++rank) {
    if (others[rank] < 0) continue;
    const float weight = kNeighbourWeights[rank] / 16.0f;
    const float *row = s.summary + int64_t(others[rank]) * kSummary;
    *count += weight;
    for (int c = 0; c < kSummary; ++c) weighted[c] += weight * row[c];
    for (int c = 0; c < 5; ++c) sizes[c] += weight * __builtin_fabsf(row[kSigned[c]]);
    *level += weight * (s.log_size[others[rank]] - s.log_size[seed]);
  }
  if (s.neighbours && others[0] >= 0) {
    for (int c = 0; c < kSummary; ++c) nearest[c] = s.summary[int64_t(others[0]) * kSummary + c];
    for (int axis = 0; axis < 2; ++axis) offset[axis] = s.offset[2 * seed + axis];
  }
  for (int c = 0; c < kCommonInputs; ++c) out[c] = __builtin_fmaxf(__builtin_fminf(out[c], kInputLimit), -kInputLimit);
}

void gather(const SeedState &s, int64_t begin, int64_t end, float *) {
  float one[kCommonInputs];
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(s, at);
    float *inputs = s.inputs + block.number() * kCommonInputs * LANES;
    for (int i = 0; i < LANES; ++i) {
      inputs_of_seed(s, block.seed[i], one);
      for (int c = 0; c < kCommonInputs; ++c) inputs[c * LANES + i] = one[c];
    }
  }
}

void multiply(const SeedState &s, int64_t begin, int64_t end, float *) {
  constexpr int kAtOnce = 4;
  for (int64_t at = begin; at < end; at += LANES) {
    const int64_t number = at / LANES;
    const float *inputs = s.inputs + number * kCommonInputs * LANES;
    for (int g = 0; g < kGroups; ++g) {
      float *product = s.product + (number * kGroups + g) * s.hidden * LANES;
      const int width = inputs_of(g);
      for (int h = 0; h < s.hidden; h += kAtOnce) {
        const int rows = s.hidden - h < kAtOnce ? s.hidden - h : kAtOnce;
        vf sum[kAtOnce] = {};
        const float *w[kAtOnce];
        for (int i = 0; i < kAtOnce; ++i) w[i] = s.first[g] + (h + (i < rows ? i : rows - 1)) * width;
        for (int c = 0; c < kCommonInputs; ++c) {
          const vf x = load(inputs + c * LANES);
          for (int i = 0; i < kAtOnce; ++i) sum[i] += x * w[i][c];
        }
        for (int i = 0; i < rows; ++i) store(product + (h + i) * LANES, sum[i]);
      }
    }
  }
}

}  // namespace
}  // namespace sgi
