// The step, forward and backward.
#include "fit/seed_descent.hpp"
#include "fit/seed_forward.hpp"
#include "fit/seed_gradients.hpp"
#include "fit/seed_inputs.hpp"

namespace sgi {
namespace {

double forward(const SeedState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *memory) {
  const Scratch scratch(s, memory);
  double bits = 0;
  for (int64_t at = begin; at < end; at += LANES) {
    const vf sum = forward_block(s, Block(at, s.count), out, scratch.hidden);
    for (int i = 0; i < LANES; ++i) bits += lane(sum, i);
  }
  return bits;
}

// Sums over the seeds of one run, as vectors over lanes that are added up at its end; only where MLP_p runs.
struct Sums {
  float *lanes;
  int rest[kGroups], base, gamma, first[kGroups];

  Sums(const SeedState &s, float *memory) : lanes(memory) {
    int at = 0;
    for (int g = 0; g < kGroups; at += s.rest_size(g++)) rest[g] = at;
    base = at;
    gamma = base + kUnits * kLevels;
    at = gamma + kGammas;
    for (int g = 0; g < kGroups; at += s.first_size(g++)) first[g] = at;
    for (int64_t i = 0; s.predicts && i < int64_t(s.sums()) * LANES; ++i) lanes[i] = 0.0f;
  }
  void add(int row, vf v) const {
    float *p = lanes + int64_t(row) * LANES;
    store(p, load(p) + v);
  }
  void add_to_lane(int row, int lane, float v) const { lanes[int64_t(row) * LANES + lane] += v; }
  void write(const SeedState &s, float *out) const {
    for (int row = 0; row < s.sums(); ++row) {
      float part[4] = {};  // four chains of additions hide each other's latency
      for (int i = 0; i < LANES; ++i) part[i % 4] += lanes[int64_t(row) * LANES + i];
      out[row] = (part[0] + part[1]) + (part[2] + part[3]);
    }
  }
};

// What a batch of blocks keeps between its way down to MLP_p's outputs and its way back through it.
struct Batch {
  int64_t first;  // number of its first block
  int blocks;
  vf own[kBatch][kMaxOwnInputs], up[kBatch][kMaxOutputs];
};

// Back through MLP_p from the gradients `up` of its outputs. A batch at a time, so that sums stay in registers.
template <int GROUP>
inline void descend(const SeedState &s, const Batch &batch, const float *hidden, const Sums &sums) {
  constexpr int kOutputs = outputs_of(GROUP);
  const float *w2 = s.rest[GROUP] + s.hidden;
  const int b1 = sums.rest[GROUP], first_w2 = b1 + s.hidden, b2 = first_w2 + kOutputs * s.hidden;
  for (int b = 0; b < batch.blocks; ++b)
    for (int o = 0; o < kOutputs; ++o) sums.add(b2 + o, batch.up[b][o]);
  for (int h = 0; h < s.hidden; ++h) {
    vf weight[kOutputs], sum[kOutputs] = {}, bias{}, down[kBatch];
    for (int o = 0; o < kOutputs; ++o) weight[o] = vf{} + w2[o * s.hidden + h];
    for (int b = 0; b < batch.blocks; ++b) {
      const vf x = load(hidden + (b * s.hidden + h) * LANES);
      vf d{};
#pragma GCC unroll 7
      for (int o = 0; o < kOutputs; ++o) {
        d += batch.up[b][o] * weight[o];
        sum[o] += batch.up[b][o] * x;
      }
      down[b] = select(x > 0.0f, d, vf{});
      bias += down[b];
    }
    for (int o = 0; o < kOutputs; ++o) sums.add(first_w2 + o * s.hidden + h, sum[o]);
    sums.add(b1 + h, bias);
    if (!s.trains_first) continue;
    const int row = sums.first[GROUP] + h * inputs_of(GROUP);
    for (int c = 0; c < inputs_of(GROUP); ++c) {
      vf total{};
      for (int b = 0; b < batch.blocks; ++b)
        total += down[b] * (c < kCommonInputs ? load(s.inputs + ((batch.first + b) * kCommonInputs + c) * LANES)
                                              : batch.own[b][c - kCommonInputs]);
      sums.add(row + c, total);
    }
  }
}

// One coding step of a batch: down to MLP_p's outputs block by block, then back through it.
template <int GROUP>
void backward_group(const SeedState &s, Batch &batch, const Scratch &scratch, const SeedGradients &g,
                    const Sums &sums) {
  const int rows = s.attributes();
  for (int b = 0; b < batch.blocks; ++b) {
    const Block block((batch.first + b) * LANES, s.count);
    const float *decoded = s.decoded + block.number() * rows * LANES;
    const float *grad = scratch.attributes + b * rows * LANES;
    if (!s.predicts) {
      descend_values(s, block, GROUP, decoded, grad, g);
      continue;
    }
    vf outputs[kMaxOutputs];
    const vf loudness = loudness_of(s, decoded);
    own_inputs(s, decoded, GROUP, loudness, batch.own[b]);
    evaluate(s, block, GROUP, batch.own[b], scratch.hidden + b * s.hidden * LANES, outputs);
    const Units u = units_of(s, block, GROUP, outputs, loudness);
    descend_group(s, block, GROUP, u, decoded, grad, g, batch.up[b], sums);
  }
  if (s.predicts) descend<GROUP>(s, batch, scratch.hidden, sums);
}

void backward(const SeedState &s, int64_t begin, int64_t end, const SeedGradients &g, float *out, float *memory) {
  const Scratch scratch(s, memory);
  const Sums sums(s, scratch.sums);
  Batch batch;
  for (int64_t at = begin; at < end; at += kBatch * LANES) {
    const int64_t left = (end - at + LANES - 1) / LANES;
    batch.first = at / LANES;
    batch.blocks = left < kBatch ? int(left) : kBatch;
    for (int b = 0; b < batch.blocks; ++b) {
      const Block block(at + b * LANES, s.count);
      const int rows = s.attributes();
      read_gradients(s, block, s.decoded + block.number() * rows * LANES, g, scratch.attributes + b * rows * LANES);
    }
    backward_group<0>(s, batch, scratch, g, sums);
    backward_group<1>(s, batch, scratch, g, sums);
    backward_group<2>(s, batch, scratch, g, sums);
  }
  if (s.predicts) sums.write(s, out);
}

}  // namespace

const SeedKernel SeedKernel::SGI_ISA{sgi::summarize, sgi::gather, sgi::multiply, sgi::forward, sgi::backward};

}  // namespace sgi
