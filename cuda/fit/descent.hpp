// From gradients of Gaussians back to those of attributes, of MLP_p and of the steps.
//
// A block takes kSeedThreads seeds at a time, group by group. Going down a thread has a seed; then it has a hidden unit
// of MLP_p and adds over the seeds, in their order. A chunk of seeds ends as one row of sums, and rows are added in
// order.
#pragma once
#include "cuda/fit/state.hpp"
#include "fit/seed_descent.hpp"
#include "fit/seed_gradients.hpp"

namespace sgi {

// Gradients of the decoded attributes [N, d_A], from those of Gaussians.
SGI_KERNEL(attribute_slopes, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  const SeedGradients g = gradients_of(a);
  for_each_seed(block, a, [&](int i) {
    const int64_t row = int64_t(i) * s.attributes();
    read_gradients(s, Block(i, a.count), s.decoded + row, g, a.slopes + row);
  });
}

// Where what MLP_p said last stands for constants.
SGI_KERNEL(descend_seeds, kSeedThreads, FitArguments) {
  const SeedState s = state_of(a);
  const SeedGradients g = gradients_of(a);
  for_each_seed(block, a, [&](int i) {
    const int64_t row = int64_t(i) * s.attributes();
    for (int group = 0; group < kGroups; ++group)
      descend_values(s, Block(i, a.count), group, s.decoded + row, a.slopes + row, g);
  });
}

namespace {

constexpr int kHiddenPitch = kMaxHidden + 1, kMaxUnits = 3;

// What a block's seeds leave for the sums over them.
struct DescentMemory {
  float hidden[kSeedThreads][kHiddenPitch];
  float up[kMaxOutputs][kSeedThreads];     // gradients of MLP_p's outputs
  float own[kMaxOwnInputs][kSeedThreads];  // inputs that a group has for itself
  float base[kMaxUnits][kSeedThreads];     // gradients of the base steps, of the level ...
  int32_t level[kSeedThreads];             // ... that is this
  float gamma[kSeedThreads];
};

// Takes what `descend_group` adds to the sums of one seed.
struct SeedSink {
  DescentMemory *memory;
  int thread, base, gamma;

  void add(int, float v) const { memory->gamma[thread] = v; }
  void add_to_lane(int row, int, float v) const {
    memory->base[row / kLevels % kMaxUnits][thread] = v;
    memory->level[thread] = row % kLevels;
  }
};

// Rows of a chunk's sums (SeedState::sums).
struct SumRows {
  int rest, base, gamma, first;
};

inline SumRows rows_of(const SeedState &s, int group) {
  SumRows rows{0, 0, 0, 0};
  int rest = 0, first = 0;
  for (int g = 0; g < kGroups; ++g) {
    if (g == group) rows.rest = rest, rows.first = first;
    rest += s.rest_size(g);
    first += s.first_size(g);
  }
  rows.base = rest;
  rows.gamma = rest + kUnits * kLevels;
  rows.first += rows.gamma + kGammas;
  return rows;
}

// Sums over seeds that a thread keeps for its hidden unit.
template <int GROUP>
struct UnitSums {
  float w2[outputs_of(GROUP)], bias, first[inputs_of(GROUP)];
  float other;  // of b2, or of a base step or γ: the thread says which
};

template <int GROUP>
inline void go_down(const SeedState &s, const FitArguments &a, const SeedGradients &g, int seed, int t,
                    DescentMemory &memory) {
  constexpr int kOutputs = outputs_of(GROUP);
  for (int o = 0; o < kOutputs; ++o) memory.up[o][t] = 0.0f;
  for (int c = 0; c < own_input_count(GROUP); ++c) memory.own[c][t] = 0.0f;
  for (int i = 0; i < kGroupUnits[GROUP]; ++i) memory.base[i][t] = 0.0f;
  for (int h = 0; h < s.hidden; ++h) memory.hidden[t][h] = 0.0f;
  memory.level[t] = 0;
  memory.gamma[t] = 0.0f;
  if (seed >= a.count) return;
  const Block one(seed, a.count);
  const int64_t row = int64_t(seed) * s.attributes();
  const float *decoded = s.decoded + row;
  float own[kMaxOwnInputs], outputs[kMaxOutputs], up[kMaxOutputs];
  const float loudness = loudness_of(s, decoded);
  own_inputs(s, decoded, GROUP, loudness, own);
  evaluate(s, one, GROUP, own, memory.hidden[t], outputs);
  const Units u = units_of(s, one, GROUP, outputs, loudness);
  const SeedSink sink{&memory, t, kFirstUnit[GROUP] % kMaxUnits ? -1 : 0, 0};
  descend_group(s, one, GROUP, u, decoded, a.slopes + row, g, up, sink);
  for (int o = 0; o < kOutputs; ++o) memory.up[o][t] = up[o];
  for (int c = 0; c < own_input_count(GROUP); ++c) memory.own[c][t] = own[c];
}

// Adds the seeds of a round, the first of which is `seed`, to what thread t sums.
template <int GROUP>
inline void add_round(const SeedState &s, int seed, int t, const DescentMemory &memory, UnitSums<GROUP> &sums) {
  constexpr int kOutputs = outputs_of(GROUP), kBases = kGroupUnits[GROUP] * kLevels;
  const float *w2 = s.rest[GROUP] + s.hidden;
  for (int n = 0; n < kSeedThreads; ++n) {
    if (t < kOutputs) sums.other += memory.up[t][n];
    const int base = t - kOutputs;
    if (base >= 0 && base < kBases && memory.level[n] == base % kLevels) sums.other += memory.base[base / kLevels][n];
    if (base == kBases) sums.other += memory.gamma[n];
    if (t >= s.hidden) continue;
    const float x = memory.hidden[n][t];
    float down = 0.0f;
    for (int o = 0; o < kOutputs; ++o) {
      down += memory.up[o][n] * w2[o * s.hidden + t];
      sums.w2[o] += memory.up[o][n] * x;
    }
    if (!(x > 0.0f)) continue;
    sums.bias += down;
    if (!s.trains_first || seed + n >= s.count) continue;
    const float *inputs = s.inputs + int64_t(seed + n) * kCommonInputs;
    for (int c = 0; c < kCommonInputs; ++c) sums.first[c] += down * inputs[c];
    for (int c = 0; c < own_input_count(GROUP); ++c) sums.first[kCommonInputs + c] += down * memory.own[c][n];
  }
}

template <int GROUP>
inline void write_sums(const SeedState &s, int t, const UnitSums<GROUP> &sums, float *out) {
  constexpr int kOutputs = outputs_of(GROUP), kBases = kGroupUnits[GROUP] * kLevels;
  const SumRows rows = rows_of(s, GROUP);
  const int w2 = rows.rest + s.hidden, base = t - kOutputs;
  if (t < kOutputs) out[w2 + kOutputs * s.hidden + t] = sums.other;
  if (base >= 0 && base < kBases) out[rows.base + kFirstUnit[GROUP] * kLevels + base] = sums.other;
  if (base == kBases && GROUP > 0) out[rows.gamma + GROUP - 1] = sums.other;
  if (t >= s.hidden) return;
  out[rows.rest + t] = sums.bias;
  for (int o = 0; o < kOutputs; ++o) out[w2 + o * s.hidden + t] = sums.w2[o];
  if (!s.trains_first) return;
  for (int c = 0; c < inputs_of(GROUP); ++c) out[rows.first + t * inputs_of(GROUP) + c] = sums.first[c];
}

template <int GROUP>
inline void descend_chunk(const ThreadBlock<kSeedThreads> &block, const FitArguments &a, int chunk,
                          DescentMemory &memory) {
  const SeedState s = state_of(a);
  const SeedGradients g = gradients_of(a);
  PerThread<UnitSums<GROUP>, kSeedThreads> sums;
  block.each([&](int t) { sums[t] = UnitSums<GROUP>{}; });
  const int begin = chunk * a.chunk, end = begin + a.chunk < a.count ? begin + a.chunk : a.count;
  for (int seed = begin; seed < end; seed += kSeedThreads) {
    block.each([&](int t) { go_down<GROUP>(s, a, g, seed + t, t, memory); });
    block.each([&](int t) { add_round<GROUP>(s, seed, t, memory, sums[t]); });
  }
  block.each([&](int t) { write_sums<GROUP>(s, t, sums[t], a.partials + int64_t(chunk) * s.sums()); });
}

}  // namespace

// Gradients of values, and partials [chunks, sums]; a chunk has a block for each group.
SGI_KERNEL(descend_networks, kSeedThreads, FitArguments) {
  SGI_SHARED(DescentMemory, memory);
  const int chunk = block.index() / kGroups;
  switch (block.index() % kGroups) {
    case 0: return descend_chunk<0>(block, a, chunk, memory);
    case 1: return descend_chunk<1>(block, a, chunk, memory);
    default: return descend_chunk<2>(block, a, chunk, memory);
  }
}

SGI_KERNEL(sum_chunks, 128, FitArguments) {
  const int width = state_of(a).sums();
  block.each([&](int t) {
    const int i = block.index() * 128 + t;
    if (i < width) a.sums[i] = sum_of_chunks(a.partials, a.chunks, width, i);
  });
}

}  // namespace sgi
