#include "fit/seed_fit.hpp"

#include <algorithm>

#include "base/isa.hpp"
#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int64_t kRun = 1024;  // seeds; a multiple of every kernel's lanes

}  // namespace

SeedFit::SeedFit(Isa isa, int threads, int channels, int hidden, const float *first, const float *rest)
    : kernel_(kernel_for<SeedKernel>(isa)), lanes_(lanes_of(isa)), threads_(threads) {
  state_.channels = channels;
  state_.hidden = hidden;
  for (int g = 0; g < kGroups; ++g) {
    first_.insert(first_.end(), first, first + state_.first_size(g));
    rest_.insert(rest_.end(), rest, rest + state_.rest_size(g));
    first += state_.first_size(g);
    rest += state_.rest_size(g);
  }
  state_.set_networks(first_.data(), rest_.data());
}

void SeedFit::set_layout(const SeedsView &seeds, int64_t n, const int32_t *neighbour, int neighbours, int colour_step) {
  half_pixels_.assign(seeds.half_pixels, seeds.half_pixels + 2 * n);
  log_size_.assign(seeds.log_size, seeds.log_size + n);
  neighbour_.assign(neighbour, neighbour + n * neighbours);
  const int64_t padded = (n + lanes_ - 1) / lanes_ * lanes_;
  summary_.resize(n * kSummary);
  kept_.resize(padded * 3 * kUnits);
  decoded_.resize(padded * state_.attributes());
  state_.count = n;
  state_.neighbours = neighbours;
  state_.colour_step = colour_step;
  state_.seeds = {half_pixels_.data(), log_size_.data()};
  state_.neighbour = neighbour_.data();
  state_.summary = summary_.data();
  state_.kept = kept_.data();
  state_.decoded = decoded_.data();
}

template <class Body>
void SeedFit::over_runs(const Body &body) {
  const int64_t runs = (state_.count + kRun - 1) / kRun;
  parallel_for(runs, threads_, [&](int64_t run) {
    thread_local std::vector<float> memory;
    memory.resize(scratch_floats(state_, lanes_));
    const int64_t begin = run * kRun;
    body(run, begin, begin + kRun < state_.count ? begin + kRun : state_.count, memory.data());
  });
}

double SeedFit::forward(const std::array<const float *, kGroups> &values, const float *steps, Rounding rounding,
                        NoiseKey key, bool predicts, const SeedGaussians &out) {
  SeedState &s = state_;
  std::copy_n(values.data(), kGroups, s.value);
  s.set_steps(steps);
  s.rounding = rounding;
  s.key = key.key;
  s.mirror = key.mirror();
  s.predicts = rounding != Rounding::kNone && predicts;
  if (s.predicts)
    over_runs([&](int64_t, int64_t begin, int64_t end, float *m) { kernel_.summarize(s, begin, end, m); });
  std::vector<double> bits((s.count + kRun - 1) / kRun);
  over_runs(
      [&](int64_t run, int64_t begin, int64_t end, float *m) { bits[run] = kernel_.forward(s, begin, end, out, m); });
  double total = 0;
  for (double b : bits) total += b;
  return total;
}

void SeedFit::backward(const SeedGradients &gradients, float *slopes) {
  const int64_t runs = (state_.count + kRun - 1) / kRun;
  partials_.resize(kSteps * runs);
  over_runs([&](int64_t run, int64_t begin, int64_t end, float *m) {
    kernel_.backward(state_, begin, end, gradients, partials_.data() + run * kSteps, m);
  });
  for (int64_t i = 0; i < kSteps; ++i) {
    double sum = 0;
    for (int64_t run = 0; run < runs; ++run) sum += partials_[run * kSteps + i];
    slopes[i] = float(sum);
  }
}

}  // namespace sgi
