// What the stream says of one seed with one Gaussian (docs/format.md, "Passes"): where the symbols of its three groups
// may lie and what each costs. Colours, then shape, then offset; each group's symbols move the grids of the next.
#pragma once
#include <cstdint>
#include <vector>

#include "bitstream/attributes.hpp"
#include "bitstream/frequency_tables.hpp"
#include "bitstream/header.hpp"

namespace sgi {

constexpr int kPlaceAttributes = 5;  // three of the shape, two of the offset
constexpr int kMaxAttributes = kMaxChannels + kPlaceAttributes;
constexpr double kDecodedUnit = 1.0 / (1 << kFractionBits);  // of decoded values

struct CodingModel {
  const AttributeModel &coding;  // of plain seeds: each group has a step of its own
  const SymbolCosts &costs = symbol_costs();

  int channels() const { return coding.channels; }
  int attributes() const { return int(coding.attributes); }
  const AttributeStep &step(Group group) const { return coding.steps[group]; }
  const AttributeGroup &group(Group group) const { return step(group).groups[0]; }
};

// The values that a group's attributes may have: mean + step * symbol in units of 2^-24, coded with tables of these
// scale indices.
struct ReconstructionGrid {
  int64_t mean[kMaxChannels], step[kMaxChannels];
  int16_t scale[kMaxChannels];

  double value(int j, int64_t symbol) const { return double(mean[j] + step[j] * symbol) * kDecodedUnit; }
  // The nearest symbol, away from the largest that a stream holds.
  int64_t nearest(int j, double value) const;
};

// A seed's attributes as symbols and as decoded.
struct Coded {
  int64_t decoded[kMaxAttributes];
  int32_t symbols[kMaxAttributes];
  int16_t scale[kMaxAttributes];
};

// Evaluates the networks for several versions of one seed, the rows.
class SeedContext {
 public:
  SeedContext(const CodingModel &model, int most_rows);

  // Begins a seed: inputs of the first network, log2 of the cell.
  void start(const int16_t *inputs, int8_t log_size);
  // Updates the inputs of the networks behind `known` with a version's groups up to it.
  void update(Group known, const Coded &coded, int row);
  // Grids of rows 0 to count - 1, after an update with each earlier group.
  void predict(Group group, int count, ReconstructionGrid *grids);

 private:
  const CodingModel &model_;
  int8_t log_size_ = 0;
  std::vector<int16_t> rows_;
  std::vector<int32_t> amplitude_;
  std::vector<int64_t> out_;
  std::vector<double> scratch_;
};

// The bits of `symbols` of a group, and the group with these symbols written into `coded`.
double bits_of(const CodingModel &model, Group group, const ReconstructionGrid &grid, const int64_t *symbols);
void commit(const CodingModel &model, Group group, const ReconstructionGrid &grid, const int64_t *symbols,
            Coded &coded);

}  // namespace sgi
