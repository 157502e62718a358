#include "fit/feature_fit.hpp"

#include <algorithm>
#include <cmath>

#include "base/isa.hpp"
#include "base/thread_pool.hpp"
#include "model/context_inputs.hpp"
#include "model/steps.hpp"

namespace sgi {
namespace {

// docs/notes/2026-11-paper-profile.md, "Beside the rasteriser", compares runs and batches of other sizes.
constexpr int64_t kMinRun = 2 * kBatchSeeds, kMaxRuns = 64;  // seeds, runs: each has sums of its own
constexpr int64_t kChunk = 1 << 13;                          // sums that are added together: a few microseconds

}  // namespace

float sign_slope(int64_t positive, int64_t count, float lmbda) {
  const double share = double(positive) / double(count);
  return share > 1e-6 && share < 1 - 1e-6 ? float(0.5 * lmbda * std::log2((1 - share) / share)) : 0.0f;
}

FeatureFit::FeatureFit(Isa isa, int threads, const FeatureModel &model, const ContextSpec &context)
    : kernel_(kernel_for<FeatureKernel>(isa)), threads_(threads), context_(context) {
  static_cast<FeatureModel &>(state_) = model;
  state_.resolutions = int(context.hash_resolutions.size());
  state_.entry_features = context.hash_features;
  state_.hash_features = state_.resolutions * context.hash_features;
}

void FeatureFit::set_layout(const int32_t *half_pixels, int64_t n, int colour_step, int64_t width, int64_t height) {
  FeatureState &s = state_;
  const HashGrid grid(context_, width, height);
  s.count = n;
  level_inputs_of<float>(0, colour_step, level_inputs_);
  half_pixels_.assign(half_pixels, half_pixels + 2 * n);
  table_starts_.assign(1, 0);
  for (const int64_t count : grid.counts()) table_starts_.push_back(table_starts_.back() + count);
  entry_.resize(n * s.resolutions * 4);
  weight_.resize(entry_.size());
  parallel_for(s.resolutions, threads_, [&](int64_t r) {
    const int64_t first = table_starts_[r] / s.entry_features;
    for (int64_t i = 0; i < n; ++i) {
      int64_t entries[4];
      int weights[4];
      grid.corners(int(r), half_pixels + 2 * i, entries, weights);
      for (int c = 0; c < 4; ++c) {
        entry_[(i * s.resolutions + r) * 4 + c] = int32_t(first + entries[c]);
        weight_[(i * s.resolutions + r) * 4 + c] = float(weights[c]) / (1 << (2 * kInputBits));
      }
    }
  });
  signs_.resize(table_starts_.back());
  positive_.resize(s.resolutions);
  steps_.resize(s.attributes());
  bias_.resize(s.context_hidden);
  kept_.resize((n + kBatchSeeds - 1) / kBatchSeeds * s.kept_rows() * kPitch);
  hash_slopes_.resize(n * s.hash_features);
  s.half_pixels = half_pixels_.data(), s.entry = entry_.data(), s.weight = weight_.data();
  s.signs = signs_.data(), s.steps = steps_.data(), s.bias = bias_.data();
  s.kept = kept_.data(), s.hash_slopes = hash_slopes_.data();
}

int64_t FeatureFit::run_size() const {
  return kMinRun * std::max<int64_t>(1, (state_.count + kMinRun * kMaxRuns - 1) / (kMinRun * kMaxRuns));
}

template <class Body>
void FeatureFit::over_runs(const Body &body) {
  const int64_t size = run_size();
  parallel_for((state_.count + size - 1) / size, threads_, [&](int64_t run) {
    thread_local std::vector<float> memory;
    memory.resize(scratch_floats(state_));
    body(run, run * size, std::min(state_.count, (run + 1) * size), memory.data());
  });
}

void FeatureFit::take_shared(const FeatureParameters &parameters, float offset_scale) {
  FeatureState &s = state_;
  s.decoders = parameters.decoders, s.first = parameters.first, s.rest = parameters.rest;
  s.theta = parameters.tables;
  for (int j = 0; j < s.attributes(); ++j)
    steps_[j] = std::exp2(parameters.steps[j]) * (j < s.first_offset() ? 1.0f : offset_scale);
  if (!s.priced) return;
  parallel_for(s.resolutions, threads_, [&](int64_t r) {
    const int64_t begin = table_starts_[r], end = table_starts_[r + 1];
    positive_[r] = kernel_.take_signs(s.theta + begin, end - begin, signs_.data() + begin);
  });
  for (int h = 0; h < s.context_hidden; ++h) {
    const float *w1 = s.first + int64_t(h) * s.context_inputs();
    bias_[h] = s.rest[h];
    for (int c = 0; c < kLevelInputs; ++c) bias_[h] += w1[c] * level_inputs_[c];
  }
}

double FeatureFit::forward(const FeatureValues &values, const FeatureParameters &parameters,
                           const FeatureDrawing &drawing, const SeedGaussians &out) {
  FeatureState &s = state_;
  s.feature = values.feature, s.scales = values.scales, s.offset = values.offset;
  s.rounding = drawing.rounding, s.priced = drawing.priced;
  s.scale = drawing.scale, s.share = drawing.share;
  s.key = drawing.key.key, s.mirror = drawing.key.mirror();
  take_shared(parameters, s.priced ? 1.0f : s.scale);
  const int64_t runs = (s.count + run_size() - 1) / run_size();
  std::vector<double> bits(runs);
  over_runs([&](int64_t run, int64_t begin, int64_t end, float *memory) {
    bits[run] = kernel_.forward(s, begin, end, out, memory);
  });
  double total = 0;
  for (const double some : bits) total += some;
  return total;
}

void FeatureFit::backward(const FeatureGradients &gradients, float lmbda, float *sums, float *tables) {
  const FeatureState &s = state_;
  const int64_t width = s.sums(s.priced), runs = (s.count + run_size() - 1) / run_size();
  partials_.resize(width * runs);
  over_runs([&](int64_t run, int64_t begin, int64_t end, float *memory) {
    float *own = partials_.data() + run * width;
    std::fill(own, own + width, 0.0f);
    kernel_.backward(s, begin, end, gradients, own, memory);
  });
  add_partials(runs, width, sums);
  if (!s.priced) return;
  add_constant_inputs(sums + s.decoders_size());
  descend_tables(lmbda, tables);
}

// Sums of all runs, in their order.
void FeatureFit::add_partials(int64_t runs, int64_t width, float *sums) const {
  parallel_for((width + kChunk - 1) / kChunk, threads_, [&](int64_t chunk) {
    const int64_t begin = chunk * kChunk, count = std::min(kChunk, width - begin);
    double total[kChunk] = {};
    for (int64_t run = 0; run < runs; ++run) {
      const float *own = partials_.data() + run * width + begin;
      for (int64_t i = 0; i < count; ++i) total[i] += own[i];
    }
    std::copy(total, total + count, sums + begin);
  });
}

// Inputs that are the same for all seeds stand in b1: the gradients of their weights are multiples of its own.
void FeatureFit::add_constant_inputs(float *sums) const {
  float *first = sums + state_.rest_size();
  for (int h = 0; h < state_.context_hidden; ++h) {
    float *w1 = first + int64_t(h) * state_.context_inputs();
    for (int c = 0; c < kLevelInputs; ++c) w1[c] = sums[h] * level_inputs_[c];
  }
}

// Of θ: straight through the signs, from what seeds see and from the entropy of each resolution's signs.
void FeatureFit::descend_tables(float lmbda, float *tables) const {
  parallel_for(state_.resolutions, threads_, [&](int64_t r) {
    const int64_t begin = table_starts_[r], end = table_starts_[r + 1];
    kernel_.descend_table(state_, int(r), begin, end, sign_slope(positive_[r], end - begin, lmbda), tables);
  });
}

}  // namespace sgi
