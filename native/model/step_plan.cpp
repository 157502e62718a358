#include "model/step_plan.hpp"

#include <algorithm>

#include "model/constants.hpp"

namespace sgi {
namespace {

constexpr int kShapeOverColour = 26;  // sixths of an octave, at amplitude 2^(-20/6)
constexpr int kPaperOffset = kStepZero - 14;

}  // namespace

std::vector<std::vector<SeedGroup>> coding_steps(const ModelSpec &spec) {
  std::vector<std::vector<SeedGroup>> steps;
  for (const SeedGroup &group : spec.groups()) {
    if (steps.empty() || spec.is_plain()) steps.emplace_back();
    steps.back().push_back(group);
  }
  return steps;
}

int input_count(const ModelSpec &spec, int step) {
  const ContextSpec &context = spec.context;
  const int hashed = int(context.hash_resolutions.size()) * context.hash_features;
  return kLevelInputs + hashed + (context.neighbours ? kNeighbourInputs : 0) + own_input_count(step);
}

int output_count(const ModelSpec &spec, const SeedGroup &group) {
  if (!spec.is_plain()) return group.size;
  if (group.name == GroupName::colour || group.name == GroupName::shape) return 3;
  return group.name == GroupName::offset ? 2 : group.size;
}

std::vector<int64_t> output_columns(const ModelSpec &spec, const SeedGroup &group) {
  const int predictions = output_count(spec, group);
  std::vector<int64_t> columns;
  for (int j = 0; j < group.size; ++j) {
    if (spec.is_plain() && group.name == GroupName::colour) {
      const int channel = j % spec.channels;
      columns.push_back(spec.channels >= 3 && channel < 3 ? channel : 0);
    } else {
      columns.push_back(j % predictions);
    }
  }
  return columns;
}

int network_outputs(const ModelSpec &spec, const std::vector<SeedGroup> &groups) {
  int outputs = int(groups.size());
  for (const SeedGroup &group : groups) outputs += 2 * output_count(spec, group);
  return outputs;
}

std::vector<int64_t> default_steps(const ModelSpec &spec, const SeedGroup &group, int colour_step) {
  std::vector<int64_t> steps;
  for (int output = 0; output < output_count(spec, group); ++output)
    for (int level = 0; level < kLevels; ++level) {
      const int over = group.name == GroupName::colour ? 0 : kShapeOverColour;
      const int fixed = group.name == GroupName::offset ? kPaperOffset : kStepZero;
      const int index = spec.is_plain() ? colour_step + over - kPerOctave * (level - 3) : fixed;
      steps.push_back(std::clamp(index, 0, kStepCount - 1));
    }
  return steps;
}

}  // namespace sgi
