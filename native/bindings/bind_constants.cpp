#include <array>

#include "bindings/bindings.hpp"
#include "model/constants.hpp"
#include "rdoq/window_kernel.hpp"

namespace nb = nanobind;

void bind_constants(nb::module_ &m) {
  for (const auto &[name, value] : {
           std::pair{"FRACTION_BITS", sgi::kFractionBits}, {"INPUT_BITS", sgi::kInputBits},
           {"MEAN_BITS", sgi::kMeanBits},                  {"GAMMA_BITS", sgi::kGammaBits},
           {"PER_OCTAVE", sgi::kPerOctave},                {"STEP_ZERO", sgi::kStepZero},
           {"STEP_COUNT", sgi::kStepCount},                {"SCALE_ZERO", sgi::kScaleZero},
           {"SCALE_COUNT", sgi::kScaleCount},              {"REFINE_LIMIT", sgi::kRefineLimit},
           {"AMPLITUDE_ZERO", sgi::kAmplitudeZero},        {"OCTAVE_LIMIT", sgi::kOctaveLimit},
           {"LEVELS", sgi::kLevels},                       {"SUMMARY", sgi::kSummary},
           {"LEVEL_INPUTS", sgi::kLevelInputs},            {"NEIGHBOUR_INPUTS", sgi::kNeighbourInputs},
           {"COLOUR_GAIN_BITS", sgi::kColourGainBits},     {"LOUDNESS_ZERO", sgi::kLoudnessZero},
           {"OFFSET_LIMIT", sgi::kOffsetLimit},            {"INPUT_LIMIT", sgi::kInputLimit},
           {"HIDDEN_LIMIT", sgi::kHiddenLimit},            {"WINDOW_PADDING", sgi::kWindowPadding},
       })
    m.attr(name) = value;
  for (const auto &[name, value] : {std::pair{"DEAD_ZONE", sgi::kDeadZone},
                                    {"DEAD_ZONE_LIMIT", sgi::kDeadZoneLimit},
                                    {"MIN_VARIANCE", sgi::kMinVariance},
                                    {"SHAPE_LIMIT", sgi::kShapeLimit},
                                    {"LEAST_MASS", sgi::kLeastMass}})
    m.attr(name) = value;
  nb::list weights, own;
  for (const int weight : sgi::kNeighbourWeights) weights.append(weight);
  for (int step = 0; step < sgi::kGroups; ++step) own.append(sgi::own_input_count(step));
  m.attr("NEIGHBOUR_WEIGHTS") = nb::tuple(weights);
  m.attr("OWN_INPUTS") = nb::tuple(own);
}
