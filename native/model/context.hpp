// The integer arithmetic around MLP_p (docs/format.md, "Context model"): what it sees of a seed, and what follows from
// what it says. Values are in units of 2^-24, inputs in units of 2^-6.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "model/context_inputs.hpp"
#include "model/network.hpp"

namespace sgi {

// Nearest seeds of earlier passes [n, ranks], -1 where there is none.
struct Neighbours {
  const int32_t *seeds;
  int ranks;
};

// Inputs 1 and 2 of the seeds `members` [n]: cell size and colour step, then, if there are ranks, what the neighbours'
// summaries [N, 7] say. Writes the first columns of out [n, stride].
void seed_inputs(const SeedsView &seeds, const Neighbours &neighbours, const int16_t *summary, const int64_t *members,
                 int64_t n, int colour_step, int16_t *out, int64_t stride);

struct AttributesView {
  const int64_t *values;  // [N, width] decoded
  int64_t width;
  int channels;
  int colour, shape;  // columns where these groups start
};

// Summaries [n, 7] and amplitude indices [n] of the seeds `members`.
void summarise(const AttributesView &attributes, const int64_t *members, int64_t n, int16_t *summary,
               int32_t *amplitude);

// Input 4 of seeds with these summaries [n, 7], for a coding step: the columns from `first` on of out
// [n, stride].
void own_inputs(const int16_t *summary, int64_t n, int step, int64_t first, int16_t *out, int64_t stride);

// A group of attributes: how MLP_p's outputs predict it and where it goes.
struct AttributeGroup {
  std::vector<int64_t> base;     // [size, kLevels] base step index of each attribute
  std::vector<int64_t> columns;  // [size] which of the group's predictions belongs to each
  int64_t gamma;
  bool follows_amplitude;
  int64_t prediction, refinement;  // its first mean, and its refinement, among those of the step
  int64_t first;                   // its first column

  int size() const { return int(columns.size()); }
};

// A coding step: one network, and the groups that it predicts.
struct AttributeStep {
  std::unique_ptr<Network> network;
  int inputs, predicted;
  std::vector<AttributeGroup> groups;
};

// Mean and step (units of 2^-24) and scale index of every attribute of a group [n, size], of n seeds in cells of
// log_size [n], by the outputs [n] of the step's network and amplitude indices [n].
void quantisers(const AttributeStep &of, const AttributeGroup &group, const int64_t *outputs, const int32_t *amplitude,
                const int8_t *log_size, int64_t n, int64_t *mean, int64_t *step, int16_t *scale);

// Writes mean + step * symbol of a group [n, size] to its columns of the rows `members` of decoded [N, width].
void dequantise(const AttributeGroup &group, const int32_t *symbols, const int64_t *mean, const int64_t *step,
                const int64_t *members, int64_t n, int64_t *decoded, int64_t width);

}  // namespace sgi
