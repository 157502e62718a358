// What MLP_p sees of seeds before it runs: summaries of all, and inputs from neighbours.
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

// What a block's seeds see besides their own values, in units of one: kCommonInputs.
inline void common_inputs(const SeedState &s, const Block &block, vf *inputs) {
  float one[kCommonInputs];
  for (int i = 0; i < LANES; ++i) {
    const int64_t seed = block.row[i];
    level_inputs_of<float>(s.seeds.log_size[seed], s.colour_step, one);
    neighbour_inputs_of<float>(s.seeds, s.neighbour + seed * s.neighbours, s.neighbours, s.summary, seed,
                               one + kLevelInputs);
    for (int c = 0; c < kCommonInputs; ++c) set_lane(inputs[c], i, clampv(one[c], from_units<float>(kInputLimit)));
  }
}

}  // namespace
}  // namespace sgi
