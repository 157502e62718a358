#include <utility>

#include "bindings/bindings.hpp"
#include "image/regular_pattern_kernel.hpp"
#include "model/constants.hpp"
#include "rdoq/window_kernel.hpp"

namespace nb = nanobind;
using namespace nb::literals;

void bind_constants(nb::module_ &m) {
  for (const auto &[name, value] : {
           std::pair{"FRACTION_BITS", sgi::kFractionBits},
           {"INPUT_BITS", sgi::kInputBits},
           {"MEAN_BITS", sgi::kMeanBits},
           {"GAMMA_BITS", sgi::kGammaBits},
           {"PER_OCTAVE", sgi::kPerOctave},
           {"STEP_ZERO", sgi::kStepZero},
           {"STEP_COUNT", sgi::kStepCount},
           {"SCALE_ZERO", sgi::kScaleZero},
           {"REFINE_LIMIT", sgi::kRefineLimit},
           {"AMPLITUDE_ZERO", sgi::kAmplitudeZero},
           {"OCTAVE_LIMIT", sgi::kOctaveLimit},
           {"LEVELS", sgi::kLevels},
           {"SUMMARY", sgi::kSummary},
           {"MAX_NEIGHBOURS", sgi::kMaxNeighbours},
           {"NEIGHBOUR_INPUTS", sgi::kNeighbourInputs},
           {"COLOUR_GAIN_BITS", sgi::kColourGainBits},
           {"LOUDNESS_ZERO", sgi::kLoudnessZero},
           {"OFFSET_LIMIT", sgi::kOffsetLimit},
           {"INPUT_LIMIT", sgi::kInputLimit},
           {"HIDDEN_LIMIT", sgi::kHiddenLimit},
           {"WINDOW_PADDING", sgi::kWindowPadding},
           {"MAX_LANES", sgi::lanes_of(sgi::Isa::avx512)},
           {"PATTERN_BLOCK", sgi::kPatternBlock},
           {"PATTERN_WINDOW", sgi::kPatternWindow},
           {"TEXTURE_ROOT_LOG", sgi::kTextureRoot},
           {"TEXTURE_MIN_LOG", sgi::kTextureLeast},
           {"CONTRAST_LIMIT", sgi::kContrastLimit},
       })
    m.attr(name) = value;
  for (const auto &[name, value] : {std::pair{"DEAD_ZONE", sgi::kDeadZone},
                                    {"DEAD_ZONE_LIMIT", sgi::kDeadZoneLimit},
                                    {"MIN_VARIANCE", sgi::kMinVariance},
                                    {"SHAPE_LIMIT", sgi::kShapeLimit},
                                    {"MIN_MASS", sgi::kMinMass}})
    m.attr(name) = value;
  m.def("own_input_count", &sgi::own_input_count, "step"_a,
        "Inputs that a seed's own earlier groups add at a coding step.");
}
