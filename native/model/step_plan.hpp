// How a seed's attributes are predicted and quantised: coding steps, predictions, base steps (docs/format.md, "Steps",
// "Predictions").
#pragma once
#include <cstdint>
#include <vector>

#include "model/spec.hpp"

namespace sgi {

// The groups that each evaluation of MLP_p predicts.
std::vector<std::vector<SeedGroup>> coding_steps(const ModelSpec &spec);

// Inputs of MLP_p at a coding step.
int input_count(const ModelSpec &spec, int step);
// Distinct predictions of a group, a mean and a scale each; and which of them belongs to each attribute [size].
int output_count(const ModelSpec &spec, const SeedGroup &group);
std::vector<int64_t> output_columns(const ModelSpec &spec, const SeedGroup &group);
// Outputs of MLP_p for these groups: means, scales and refinements.
int network_outputs(const ModelSpec &spec, const std::vector<SeedGroup> &groups);

// Whether a group's steps follow the amplitude.
inline bool follows_amplitude(const ModelSpec &spec, const SeedGroup &group) {
  return spec.is_plain() && group.name != GroupName::colour;
}
// Indices [output_count, kLevels] of the base steps, before what the stream adds.
std::vector<int64_t> default_steps(const ModelSpec &spec, const SeedGroup &group, int colour_step);

// Indices [output_count, kLevels] of a group's base steps, and the exponent of the amplitude in sixteenths.
struct GroupSteps {
  std::vector<int64_t> base;
  int gamma;
};

}  // namespace sgi
