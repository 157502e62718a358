// What MLP_p sees of a seed (docs/format.md, "Context model"), written once for the integers of coding, int in units of
// 2^-6, and the floats of the fit in units of one, where a vector holds a seed in each lane.
#pragma once
#include <cstdint>

#include "base/scalar.hpp"
#include "model/constants.hpp"
#include "model/seed_gaussians.hpp"

namespace sgi {

namespace {

inline int level_of(int log_size) { return log_size < 0 ? 0 : log_size < kLevels ? log_size : kLevels - 1; }

// `value` units of 2^-6 as an input.
template <class T>
T from_units(int value);
template <>
inline int from_units(int value) {
  return value;
}
template <>
inline float from_units(int value) {
  return float(value) * (1.0f / (1 << kInputBits));
}

inline int sixteenth(int value) { return value >> 4; }
inline float sixteenth(float value) { return value * 0.0625f; }

inline int64_t floor_divide(int64_t a, int64_t b) { return b == 1 ? a : a / b - (a % b < 0); }

// A decoded value times 2^gain_bits.
inline int value_input(int64_t value, int gain_bits) {
  return int(clampv(value >> (kFractionBits - kInputBits - gain_bits), int64_t(kInputLimit)));
}
template <class V>
inline V value_input(V value, int gain_bits) {
  return clampv(value * float(1 << gain_bits), from_units<float>(kInputLimit));
}

// The loudness, from the amplitude index or from the amplitude's octaves.
inline int loudness_input(int32_t amplitude) {
  return int(floor_divide(int64_t(amplitude) * (1 << kInputBits), kPerOctave)) + (kLoudnessZero << kInputBits);
}
template <class V>
inline V loudness_input(V octaves) {
  return octaves + float(kLoudnessZero);
}

// Columns 0 to 2 of a summary, from `colour`(channel).
template <class Value, class Colour, class T>
inline void summarise_colour(int channels, Colour colour, T *row) {
  for (int j = 0; j < 3; ++j) row[j] = value_input(j == 0 || channels >= 3 ? colour(j) : Value{}, kColourGainBits);
}

// Columns 4 to 6, from `shape`(index).
template <class Shape, class T>
inline void summarise_shape(Shape shape, T *row) {
  for (int j = 0; j < 3; ++j) row[4 + j] = value_input(shape(j), 0);
}

// A seed's own earlier groups, from its summary: own_input_count(step) numbers.
template <class T, class Out>
inline void own_inputs_of(const T *row, int step, Out *out) {
  if (step == 0) return;
  for (int j = 0; j < 3; ++j) {
    out[j] = Out(row[j]);
    out[3 + j] = Out(absv(row[j]));
  }
  out[6] = Out(row[3]);
  if (step == 1) return;
  for (int j = 0; j < 3; ++j) out[7 + j] = Out(row[4 + j]);
  for (int j = 0; j < 2; ++j) out[10 + j] = Out(absv(row[5 + j]));
}

// Cell size and colour step: kLevelInputs numbers.
template <class T, class Out>
inline void level_inputs_of(int log_size, int colour_step, Out *out) {
  for (int level = 0; level < kLevels; ++level) out[level] = Out(from_units<T>(0));
  out[level_of(log_size)] = Out(from_units<T>(1 << kInputBits));
  out[kLevels] = Out(from_units<T>((colour_step << kInputBits) / 12));
}

// What neighbours say: kNeighbourInputs numbers. `ranked` [ranks]: nearest first, negative from where there are no
// more; summary [N, kSummary] of decoded seeds.
template <class T, class Out>
inline void neighbour_inputs_of(const SeedsView &seeds, const int32_t *ranked, int ranks, const Out *summary,
                                int64_t seed, Out *out) {
  constexpr int kSigned[5] = {0, 1, 2, 5, 6};
  const int own_log = seeds.log_size[seed];
  int count = 0, level = 0;
  T weighted[kSummary] = {}, sizes[5] = {};
  for (int rank = 0; rank < ranks && ranked[rank] >= 0; ++rank) {
    const Out *row = summary + int64_t(ranked[rank]) * kSummary;
    const int weight = kNeighbourWeights[rank];
    count += weight;
    level += weight * (seeds.log_size[ranked[rank]] - own_log);
    for (int j = 0; j < kSummary; ++j) weighted[j] += T(weight) * T(row[j]);
    for (int j = 0; j < 5; ++j) sizes[j] += T(weight) * absv(T(row[kSigned[j]]));
  }
  *out++ = Out(sixteenth(from_units<T>(count << kInputBits)));
  for (const T value : weighted) *out++ = Out(sixteenth(value));
  for (const T value : sizes) *out++ = Out(sixteenth(value));
  *out++ = Out(sixteenth(from_units<T>(level * (1 << kInputBits))));
  const bool alone = !ranks || ranked[0] < 0;
  for (int j = 0; j < kSummary; ++j) *out++ = alone ? Out(0) : summary[int64_t(ranked[0]) * kSummary + j];
  for (int axis = 0; axis < 2; ++axis) {
    const int64_t from = seeds.half_pixels[2 * seed + axis];
    const int64_t away = alone ? 0 : (int64_t(seeds.half_pixels[2 * int64_t(ranked[0]) + axis]) - from);
    const int64_t cells = (away * (1 << kInputBits)) >> (own_log + 1);
    *out++ = Out(from_units<T>(int(clampv(cells, int64_t(kOffsetLimit) << kInputBits))));
  }
}

}  // namespace
}  // namespace sgi
