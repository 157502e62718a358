#include "rdoq/coding.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sgi {
namespace {

constexpr double kFarthest = (1 << 20) - 64;  // leaves room for moves below the bound of the format

}  // namespace

double SymbolBits::of(int64_t symbol, int scale) const {
  const int table = first + scale;
  const int64_t beyond = std::abs(symbol) - support[table];
  if (beyond <= 0) return bits[start[table] + support[table] + symbol];
  const int exponent = 63 - __builtin_clzll(static_cast<unsigned long long>(beyond));
  return bits[start[table] + 2 * support[table] + 1] + std::min(exponent + 1, 20) + exponent + 1;
}

CodingModel::CodingModel(const AttributeModel &coding, const SymbolBits &tables_)
    : channels(coding.channels), tables(tables_) {
  for (int g = 0; g < kGroups; ++g) {
    const AttributeStep &step = coding.steps[size_t(g)];
    const AttributeGroup &group = step.groups[0];
    networks[g] = step.network.get(), inputs[g] = step.inputs;
    plans[g] = {group.base.data(), group.columns.data(), nullptr, group.gamma, group.size()};
  }
}

int64_t ReconstructionGrid::nearest(int j, double value) const {
  const double position = std::rint((value / kUnit - double(mean[j])) / double(step[j]));
  return static_cast<int64_t>(std::min(std::max(position, -kFarthest), kFarthest));
}

SeedContext::SeedContext(const CodingModel &model, int most_rows) : model_(model) {
  int outputs = 0;
  int64_t scratch = 0;
  for (const Network *network : model.networks) {
    outputs = std::max(outputs, network->outputs());
    scratch = std::max(scratch, network->scratch_size());
  }
  rows_.resize(size_t(most_rows) * model.inputs[kOffset]);
  amplitude_.resize(most_rows);
  out_.resize(size_t(most_rows) * outputs);
  scratch_.resize(scratch);
}

void SeedContext::start(const int16_t *inputs, int8_t log_size) {
  log_size_ = log_size;
  for (size_t row = 0; row < amplitude_.size(); ++row)
    std::copy_n(inputs, model_.inputs[kColour], rows_.data() + row * model_.inputs[kOffset]);
}

void SeedContext::update(Group known, const Coded &coded, int row) {
  const AttributesView view{coded.decoded, model_.attributes(), model_.channels, 0, model_.channels};
  constexpr int64_t kOnly = 0;
  int16_t summary[kSummary];
  summarise(view, &kOnly, 1, summary, amplitude_.data() + row);
  const int64_t stride = model_.inputs[kOffset];
  own_inputs(summary, 1, known + 1, model_.inputs[kColour], rows_.data() + row * stride, stride);
}

void SeedContext::predict(Group group, int count, ReconstructionGrid *grids) {
  const Network &network = *model_.networks[group];
  network.evaluate(rows_.data(), model_.inputs[kOffset], count, scratch_.data(), out_.data());
  const int outputs = network.outputs(), units = (outputs - 1) / 2;
  GroupPlan plan = model_.plans[group];
  for (int row = 0; row < count; ++row) {
    const int64_t *out = out_.data() + int64_t(row) * outputs;
    if (group != kColour) plan.amplitude = amplitude_.data() + row;
    quantisers(plan, {out, out + units, out + 2 * units, outputs}, &log_size_, 1, grids[row].mean, grids[row].step,
               grids[row].scale);
  }
}

double bits_of(const CodingModel &model, Group group, const ReconstructionGrid &grid, const int64_t *symbols) {
  double bits = 0;
  for (int j = 0; j < model.plans[group].size; ++j) bits += model.tables.of(symbols[j], grid.scale[j]);
  return bits;
}

void commit(const CodingModel &model, Group group, const ReconstructionGrid &grid, const int64_t *symbols,
            Coded &coded) {
  const int first = model.first_column(group);
  for (int j = 0; j < model.plans[group].size; ++j) {
    coded.symbols[first + j] = int32_t(symbols[j]);
    coded.decoded[first + j] = grid.mean[j] + grid.step[j] * symbols[j];
    coded.scale[first + j] = grid.scale[j];
  }
}

}  // namespace sgi
