// Steps in logarithms: int64_t counts sixths of an octave, as coded; floats, or vectors of them, octaves, as fitted.
#pragma once
#include <cstdint>

#include "base/scalar.hpp"
#include "model/constants.hpp"

namespace sgi {

constexpr float octaves(int sixths) { return float(sixths) / kPerOctave; }

// The step of an index 0 to kStepCount - 1, units of 2^-24.
int64_t step_of(int64_t index);

namespace {

// How far an amplitude `above` kAmplitudeZero makes steps smaller.
inline int64_t fall_with(int64_t gamma, int64_t above) { return (gamma * above) >> kGammaBits; }
template <class V>
inline V fall_with(float gamma, V above) {
  return gamma * above;
}

// A base step refined, before it is held to the table.
inline int64_t refined_step(int64_t base, int64_t fall, int64_t refine) {
  return base - fall + clampv(refine, int64_t(kRefineLimit));
}
template <class V>
inline V refined_step(V base, V fall, V refine) {
  return base - fall + clampv(refine, octaves(kRefineLimit));
}

}  // namespace
}  // namespace sgi
