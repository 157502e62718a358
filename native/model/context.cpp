#include "model/context.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "model/steps.hpp"

namespace sgi {
namespace {

constexpr int64_t kCoarseLimit = int64_t(1) << 20, kMeanLimit = int64_t(1) << 20;

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
                 int64_t n, int colour_step, int16_t *out, int64_t stride) {
  for (int64_t i = 0; i < n; ++i) {
    const int64_t seed = members[i];
    int16_t *row = out + i * stride;
    level_inputs_of<int>(seeds.log_size[seed], colour_step, row);
    if (neighbours.ranks)
      neighbour_inputs_of<int>(seeds, neighbours.seeds + i * neighbours.ranks, neighbours.ranks, summary, seed,
                               row + kLevelInputs);
  }
}

void summarise(const AttributesView &a, const int64_t *members, int64_t n, int16_t *summary, int32_t *amplitude) {
  for (int64_t i = 0; i < n; ++i) {
    const int64_t *colour = a.values + members[i] * a.width + a.colour;
    const int64_t *shape = a.values + members[i] * a.width + a.shape;
    int16_t *row = summary + i * kSummary;
    amplitude[i] = amplitude_index(colour, a.channels);
    summarise_colour<int64_t>(a.channels, [&](int j) { return colour[j]; }, row);
    row[3] = int16_t(loudness_input(amplitude[i]));
    summarise_shape([&](int j) { return shape[j]; }, row);
  }
}

void own_inputs(const int16_t *summary, int64_t n, int step, int64_t first, int16_t *out, int64_t stride) {
  for (int64_t i = 0; i < n; ++i) own_inputs_of(summary + i * kSummary, step, out + i * stride + first);
}

void quantisers(const AttributeStep &of, const AttributeGroup &group, const int64_t *outputs, const int32_t *amplitude,
                const int8_t *log_size, int64_t n, int64_t *mean, int64_t *step, int16_t *scale) {
  const int size = group.size();
  for (int64_t i = 0; i < n; ++i, outputs += of.network->outputs()) {
    const int level = level_of(log_size[i]);
    const int64_t *means = outputs + group.prediction, *scales = means + of.predicted;
    const int64_t refine = outputs[2 * of.predicted + group.refinement];
    const int64_t fall = group.follows_amplitude ? fall_with(group.gamma, int64_t(amplitude[i]) - kAmplitudeZero) : 0;
    for (int j = 0; j < size; ++j) {
      const int64_t at = i * size + j, from = group.columns[size_t(j)];
      const int64_t base = group.base[size_t(j * kLevels + level)];
      const int64_t index = std::clamp<int64_t>(refined_step(base, fall, refine), 0, kStepCount - 1);
      mean[at] = (std::clamp(means[from], -kMeanLimit, kMeanLimit) * step_of(base)) >> kMeanBits;
      step[at] = step_of(index);
      scale[at] = int16_t(std::clamp<int64_t>(kScaleZero + scales[from] + base - index, 0, kScaleCount - 1));
    }
  }
}

void dequantise(const AttributeGroup &group, const int32_t *symbols, const int64_t *mean, const int64_t *step,
                const int64_t *members, int64_t n, int64_t *decoded, int64_t width) {
  const int size = group.size();
  for (int64_t i = 0; i < n; ++i) {
    int64_t *to = decoded + members[i] * width + group.first;
    for (int64_t at = i * size; at < (i + 1) * size; ++at) *to++ = mean[at] + step[at] * symbols[at];
  }
}

}  // namespace sgi
