#include "model/context.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>

#include "base/thread_pool.hpp"
#include "model/network.hpp"

namespace sgi {
namespace {

constexpr int kFractionBits = 24;
constexpr int kSummaryLimit = 1 << 13;
constexpr int kWeights[kMostRanks] = {4, 3, 3, 2, 2, 2};  // sixteenths, nearest first
constexpr int kAbsolute[5] = {0, 1, 2, 5, 6};             // of the summary
constexpr int64_t kOffsetLimit = 8 << kInputBits;
constexpr int64_t kCoarseLimit = int64_t(1) << 20;
constexpr int kScales = 64, kScaleZero = 24, kRefineLimit = 24, kAmplitudeZero = -20, kGammaBits = 4;
constexpr int64_t kMeanLimit = int64_t(1) << 20;

template <class Body>
void for_each_seed(int64_t n, int threads, Body body) {
  constexpr int64_t kChunk = 1024;
  parallel_for((n + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    for (int64_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i) body(i);
  });
}

int64_t floor_divide(int64_t a, int64_t b) { return b == 1 ? a : a / b - (a % b < 0); }

int16_t as_input(int64_t value) { return int16_t(std::clamp<int64_t>(value, -kSummaryLimit, kSummaryLimit)); }

int level_of(int log_size) { return std::clamp(log_size, 0, kLevels - 1); }

void neighbour_inputs(const SeedsView &seeds, const int32_t *ranked, int ranks, const int16_t *summary, int64_t seed,
                      int16_t *out) {
  const int own_log = seeds.log_size[seed];
  int count = 0, level = 0, weighted[kSummary] = {}, absolute[5] = {};
  for (int rank = 0; rank < ranks && ranked[rank] >= 0; ++rank) {
    const int16_t *row = summary + int64_t(ranked[rank]) * kSummary;
    const int weight = kWeights[rank];
    count += weight;
    level += weight * (seeds.log_size[ranked[rank]] - own_log);
    for (int j = 0; j < kSummary; ++j) weighted[j] += weight * row[j];
    for (int j = 0; j < 5; ++j) absolute[j] += weight * std::abs(int(row[kAbsolute[j]]));
  }
  *out++ = int16_t((count << kInputBits) >> 4);
  for (int value : weighted) *out++ = int16_t(value >> 4);
  for (int value : absolute) *out++ = int16_t(value >> 4);
  *out++ = int16_t((level * (1 << kInputBits)) >> 4);
  if (ranked[0] < 0) {
    std::fill_n(out, kSummary + 2, int16_t(0));
    return;
  }
  out = std::copy_n(summary + int64_t(ranked[0]) * kSummary, kSummary, out);
  for (int d = 0; d < 2; ++d) {
    const int64_t away = int64_t(seeds.half_pixels[2 * int64_t(ranked[0]) + d]) - seeds.half_pixels[2 * seed + d];
    const int64_t cells = (away * (1 << kInputBits)) >> (own_log + 1);
    *out++ = int16_t(std::clamp(cells, -kOffsetLimit, kOffsetLimit));
  }
}

// floor(3 log2 E) - 72 for the energy E of values rounded to 2^-12: thirds of an octave of the energy.
int32_t amplitude_index(const int64_t *values, int count) {
  int64_t energy = 0;
  for (int j = 0; j < count; ++j) {
    const int64_t coarse = std::clamp(values[j] >> (kFractionBits / 2), -kCoarseLimit, kCoarseLimit);
    energy += coarse * coarse;
  }
  // The bits of a double tell its exponent and, with another one in their place, its mantissa in 1..2.
  const double exact = double(std::max<int64_t>(energy, 1));
  uint64_t bits;
  std::memcpy(&bits, &exact, sizeof bits);
  const auto exponent = int32_t(bits >> 52) - 1023;
  bits = (bits & ((uint64_t(1) << 52) - 1)) | uint64_t(1023) << 52;
  double mantissa;
  std::memcpy(&mantissa, &bits, sizeof mantissa);
  const int third = (mantissa >= 2 * 0.6299605249474366) + (mantissa >= 2 * 0.7937005259840998);
  return 3 * exponent + third - 3 * kFractionBits;
}

std::array<int64_t, kStepCount> all_steps() {
  // 2^(k/6) in units of 2^-40; octaves are shifts of these.
  constexpr int64_t kSixths[kPerOctave] = {1099511627776, 1234160073853, 1385297844439,
                                           1554944255988, 1745365914583, 1959106999532};
  std::array<int64_t, kStepCount> steps{};
  for (int index = 0; index < kStepCount; ++index) {
    const int shift = 32 - index / kPerOctave;
    steps[index] = (kSixths[index % kPerOctave] + (int64_t(1) << (shift - 1))) >> shift;
  }
  return steps;
}

const std::array<int64_t, kStepCount> kSteps = all_steps();

}  // namespace

int64_t step_of(int64_t index) { return kSteps[size_t(index)]; }

void seed_inputs(const SeedsView &seeds, const Neighbours &neighbours, const int16_t *summary, const int64_t *members,
                 int64_t n, int quality, int threads, int16_t *out, int64_t stride) {
  for_each_seed(n, threads, [&](int64_t i) {
    const int64_t seed = members[i];
    int16_t *row = out + i * stride;
    std::fill_n(row, kLevels, int16_t(0));
    row[level_of(seeds.log_size[seed])] = 1 << kInputBits;
    row[kLevels] = int16_t((quality << kInputBits) / 12);
    if (neighbours.ranks)
      neighbour_inputs(seeds, neighbours.seeds + i * neighbours.ranks, neighbours.ranks, summary, seed,
                       row + kLevelInputs);
  });
}

void summarise(const AttributesView &a, const int64_t *members, int64_t n, int threads, int16_t *summary,
               int32_t *amplitude) {
  const int shown = a.channels >= 3 ? 3 : 1;
  for_each_seed(n, threads, [&](int64_t i) {
    const int64_t *colour = a.values + members[i] * a.width + a.colour;
    const int64_t *shape = a.values + members[i] * a.width + a.shape;
    int16_t *row = summary + i * kSummary;
    amplitude[i] = amplitude_index(colour, a.per_seed * a.channels);
    for (int j = 0; j < 3; ++j) {
      int64_t colours = 0, shapes = 0;
      for (int k = 0; k < a.per_seed; ++k) {
        if (j < shown) colours += colour[k * a.channels + j];
        shapes += shape[k * 3 + j];
      }
      row[j] = as_input(floor_divide(colours, a.per_seed) >> (kFractionBits - kInputBits - 4));
      row[4 + j] = as_input(floor_divide(shapes, a.per_seed) >> (kFractionBits - kInputBits));
    }
    const int64_t loudness = int64_t(amplitude[i]) * (1 << kInputBits);
    row[3] = as_input(floor_divide(loudness, kPerOctave) + (6 << kInputBits));
  });
}

void own_inputs(const int16_t *summary, int64_t n, int step, int64_t first, int threads, int16_t *out, int64_t stride) {
  const auto size = [](int16_t value) { return int16_t(std::abs(int(value))); };
  for_each_seed(n, threads, [&](int64_t i) {
    const int16_t *row = summary + i * kSummary;
    int16_t *to = out + i * stride + first;
    to = std::copy_n(row, 3, to);
    to = std::transform(row, row + 3, to, size);
    *to++ = row[3];
    if (step >= 2) std::transform(row + 5, row + 7, std::copy_n(row + 4, 3, to), size);
  });
}

void quantisers(const GroupPlan &plan, const PredictionView &prediction, const int8_t *log_size, int64_t n,
                int threads, int64_t *mean, int64_t *step, int16_t *scale) {
  for_each_seed(n, threads, [&](int64_t i) {
    const int level = level_of(log_size[i]);
    const int64_t refine = prediction.refine[i * prediction.stride];
    int64_t change = std::clamp<int64_t>(refine, -kRefineLimit, kRefineLimit);
    if (plan.amplitude) change -= (plan.gamma * (plan.amplitude[i] - kAmplitudeZero)) >> kGammaBits;
    for (int j = 0; j < plan.size; ++j) {
      const int64_t at = i * plan.size + j, from = i * prediction.stride + plan.columns[j];
      const int64_t base = plan.base[int64_t(j) * kLevels + level];
      const int64_t index = std::clamp<int64_t>(base + change, 0, kStepCount - 1);
      mean[at] = (std::clamp(prediction.mean[from], -kMeanLimit, kMeanLimit) * step_of(base)) >> kMeanBits;
      step[at] = step_of(index);
      scale[at] = int16_t(std::clamp<int64_t>(kScaleZero + prediction.scale[from] + base - index, 0, kScales - 1));
    }
  });
}

void dequantise(const int32_t *symbols, const int64_t *mean, const int64_t *step, const int64_t *members, int64_t n,
                int64_t size, int64_t first, int threads, int64_t *decoded, int64_t width) {
  for_each_seed(n, threads, [&](int64_t i) {
    int64_t *to = decoded + members[i] * width + first;
    for (int64_t at = i * size; at < (i + 1) * size; ++at) *to++ = mean[at] + step[at] * symbols[at];
  });
}

}  // namespace sgi
