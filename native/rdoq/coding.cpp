#include "rdoq/coding.hpp"

#include <algorithm>
#include <cmath>

namespace sgi {
namespace {

constexpr double kFarthest = (1 << 20) - 64;  // leaves room for moves below the bound of the format

}  // namespace

int64_t ReconstructionGrid::nearest(int j, double value) const {
  const double position = std::rint((value / kDecodedUnit - double(mean[j])) / double(step[j]));
  return static_cast<int64_t>(std::min(std::max(position, -kFarthest), kFarthest));
}

SeedContext::SeedContext(const CodingModel &model, int most_rows) : model_(model) {
  int outputs = 0;
  int64_t scratch = 0;
  for (const AttributeStep &step : model.coding.steps) {
    outputs = std::max(outputs, step.network->outputs());
    scratch = std::max(scratch, step.network->scratch_size());
  }
  rows_.resize(size_t(most_rows) * model.step(kOffset).inputs);
  amplitude_.resize(most_rows);
  out_.resize(size_t(most_rows) * outputs);
  scratch_.resize(scratch);
}

void SeedContext::start(const int16_t *inputs, int8_t log_size) {
  log_size_ = log_size;
  for (size_t row = 0; row < amplitude_.size(); ++row)
    std::copy_n(inputs, model_.step(kColour).inputs, rows_.data() + row * model_.step(kOffset).inputs);
}

void SeedContext::update(Group known, const Coded &coded, int row) {
  const AttributesView view{coded.decoded, model_.attributes(), model_.channels(), 0, model_.channels()};
  constexpr int64_t kOnly = 0;
  int16_t summary[kSummary];
  summarise(view, &kOnly, 1, summary, amplitude_.data() + row);
  const int64_t stride = model_.step(kOffset).inputs;
  own_inputs(summary, 1, known + 1, model_.step(kColour).inputs, rows_.data() + row * stride, stride);
}

void SeedContext::predict(Group group, int count, ReconstructionGrid *grids) {
  const AttributeStep &step = model_.step(group);
  step.network->evaluate(rows_.data(), model_.step(kOffset).inputs, count, scratch_.data(), out_.data());
  for (int row = 0; row < count; ++row)
    quantisers(step, step.groups[0], out_.data() + int64_t(row) * step.network->outputs(), amplitude_.data() + row,
               &log_size_, 1, grids[row].mean, grids[row].step, grids[row].scale);
}

double bits_of(const CodingModel &model, Group group, const ReconstructionGrid &grid, const int64_t *symbols) {
  double bits = 0;
  for (int j = 0; j < model.group(group).size(); ++j)
    bits += model.costs.bits(symbols[j], model.coding.first_table + grid.scale[j]);
  return bits;
}

void commit(const CodingModel &model, Group group, const ReconstructionGrid &grid, const int64_t *symbols,
            Coded &coded) {
  const int first = model.group(group).first;
  for (int j = 0; j < model.group(group).size(); ++j) {
    coded.symbols[first + j] = int32_t(symbols[j]);
    coded.decoded[first + j] = grid.mean[j] + grid.step[j] * symbols[j];
    coded.scale[first + j] = grid.scale[j];
  }
}

}  // namespace sgi
