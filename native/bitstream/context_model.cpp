#include "bitstream/context_model.hpp"

#include <utility>

#include "bitstream/arrays.hpp"
#include "bitstream/frequency_tables.hpp"

namespace sgi {
namespace {

// A network of a coding step, without weights.
IntNetwork empty_network(const ModelSpec &spec, int step, const std::vector<SeedGroup> &groups) {
  IntNetwork network{};
  network.inputs = input_count(spec, step), network.hidden = spec.context.hidden;
  network.outputs = network_outputs(spec, groups);
  network.predicted = (network.outputs - int(groups.size())) / 2;
  network.w1.resize(size_t(network.hidden) * size_t(network.inputs)), network.b1.resize(size_t(network.hidden));
  network.w2.resize(size_t(network.outputs) * size_t(network.hidden)), network.b2.resize(size_t(network.outputs));
  return network;
}

}  // namespace

template <class Coder>
void code_networks(Coder &coder, const ModelSpec &spec, Networks &networks) {
  if (spec.context.prior) {
    if (Coder::kReads) networks = load_prior(spec);
    return;
  }
  const auto steps = coding_steps(spec);
  for (size_t step = 0; step < steps.size(); ++step) {
    IntNetwork network = Coder::kReads ? empty_network(spec, int(step), steps[step]) : *networks[step];
    coder.number(kShiftBits, network.shift);
    for (std::vector<int64_t> *weights : {&network.w1, &network.b1, &network.w2, &network.b2})
      code_weights(coder, *weights);
    network.require_exact();
    if (Coder::kReads) networks.push_back(std::make_shared<const IntNetwork>(std::move(network)));
  }
}

template void code_networks(SymbolReader &coder, const ModelSpec &spec, Networks &networks);
template void code_networks(SymbolWriter &coder, const ModelSpec &spec, Networks &networks);

AttributeModel attribute_model(const ModelSpec &spec, const std::vector<GroupSteps> &plan, const Networks &networks,
                               int colour_step, int family, Isa isa) {
  AttributeModel model;
  model.attributes = spec.attributes(), model.channels = spec.channels;
  model.colour = 0, model.shape = spec.is_plain() ? spec.channels : 0;
  model.colour_step = colour_step, model.ranks = spec.context.neighbours,
  model.first_table = int16_t(kFamilySize * family);
  model.isa = isa;
  auto steps_of = plan.begin();
  const auto steps = coding_steps(spec);
  for (size_t s = 0; s < steps.size(); ++s) {
    const IntNetwork &network = *networks[s];
    AttributeStep step{std::make_unique<Network>(network, isa), network.inputs, network.predicted, {}};
    int64_t units = 0;
    for (size_t g = 0; g < steps[s].size(); ++g, ++steps_of) {
      const SeedGroup &group = steps[s][g];
      std::vector<int64_t> columns = output_columns(spec, group), base;
      for (const int64_t column : columns)
        base.insert(base.end(), steps_of->base.begin() + column * kLevels,
                    steps_of->base.begin() + (column + 1) * kLevels);
      step.groups.push_back({std::move(base), std::move(columns), steps_of->gamma, follows_amplitude(spec, group),
                             units, int64_t(g), group.start});
      units += output_count(spec, group);
    }
    model.steps.push_back(std::move(step));
  }
  return model;
}

}  // namespace sgi
