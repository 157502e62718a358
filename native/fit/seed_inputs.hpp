// What MLP_p sees of all seeds before it runs: summaries, inputs from neighbours, and their products with its first
// layer.
#pragma once
#include "fit/seed_block.hpp"

namespace sgi {
namespace {

// `rows`: memory for a block's attributes.
inline void summarize_rows(const SeedState &s, int64_t begin, int64_t end, float *rows) {
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(at, s.count);
    for (int g = 0; g < 2; ++g)
      for (int j = 0; j < s.group_size(g); ++j)
        store(rows + (s.group_start(g) + j) * LANES, block.gather(s.value[g], s.group_size(g), j));
    vf row[kSummary];
    colour_summary(s, rows, row);
    row[3] = loudness_input(loudness_of(s, rows));
    shape_summary(s, rows, row);
    for (int c = 0; c < kSummary; ++c) block.scatter(row[c], s.summary, kSummary, c);
  }
}

inline void summarize(const SeedState &s, int64_t begin, int64_t end, float *memory) {
  summarize_rows(s, begin, end, Scratch(s, memory).attributes);
}

// Inputs of one seed in units of one.
inline void inputs_of_seed(const SeedState &s, int64_t seed, float *out) {
  level_inputs_of<float>(s.seeds.log_size[seed], s.quality, out);
  neighbour_inputs_of<float>(s.seeds, s.neighbour + seed * s.neighbours, s.neighbours, s.summary, seed,
                             out + kLevelInputs);
  for (int c = 0; c < kCommonInputs; ++c) out[c] = clampv(out[c], from_units<float>(kInputLimit));
}

inline void gather(const SeedState &s, int64_t begin, int64_t end, float *) {
  float one[kCommonInputs];
  for (int64_t at = begin; at < end; at += LANES) {
    const Block block(at, s.count);
    float *inputs = s.inputs + block.number() * kCommonInputs * LANES;
    for (int i = 0; i < LANES; ++i) {
      inputs_of_seed(s, block.row[i], one);
      for (int c = 0; c < kCommonInputs; ++c) inputs[c * LANES + i] = one[c];
    }
  }
}

inline void multiply(const SeedState &s, int64_t begin, int64_t end, float *) {
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
