#include "bitstream/context_model.hpp"

#include <utility>

#include "bitstream/arrays.hpp"
#include "bitstream/frequency_tables.hpp"

namespace sgi {
namespace {

IntNetwork read_network(SymbolReader &reader, const ModelSpec &spec, int step, const std::vector<SeedGroup> &groups) {
  IntNetwork network;
  network.inputs = input_count(spec, step), network.hidden = spec.context.hidden;
  network.outputs = network_outputs(spec, groups);
  network.predicted = (network.outputs - int(groups.size())) / 2;
  network.shift = reader.number(kShiftBits);
  network.w1 = read_weights(reader, int64_t(network.hidden) * network.inputs);
  network.b1 = read_weights(reader, network.hidden);
  network.w2 = read_weights(reader, int64_t(network.outputs) * network.hidden);
  network.b2 = read_weights(reader, network.outputs);
  network.require_exact();
  return network;
}

}  // namespace

Networks read_networks(SymbolReader &reader, const ModelSpec &spec) {
  if (spec.context.prior) return load_prior(spec);
  Networks networks;
  const auto steps = coding_steps(spec);
  for (size_t step = 0; step < steps.size(); ++step)
    networks.push_back(std::make_shared<const IntNetwork>(read_network(reader, spec, int(step), steps[step])));
  return networks;
}

AttributeModel attribute_model(const ModelSpec &spec, const std::vector<GroupSteps> &plan, const Networks &networks,
                               int quality, int family, Isa isa) {
  AttributeModel model;
  model.attributes = spec.attributes(), model.channels = spec.channels;
  model.colour = 0, model.shape = spec.is_plain() ? spec.channels : 0;
  model.quality = quality, model.ranks = spec.context.neighbours, model.first_table = int16_t(kFamilySize * family);
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
