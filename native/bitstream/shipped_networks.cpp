#include "bitstream/shipped_networks.hpp"

#include <string>

#include "base/error.hpp"
#include "bitstream/shipped.hpp"
#include "model/step_plan.hpp"

namespace sgi {
Networks parse_networks(Bytes file) {
  size_t at = 0;
  const auto next = [&] {
    const auto value = int16_t(uint16_t(file.data[at] | file.data[at + 1] << 8));
    at += 2;
    return int(value);
  };
  const auto tensor = [&](int rows, int columns) {
    std::vector<int64_t> values;
    for (int i = 0; i < rows * columns; ++i) values.push_back(next());
    return values;
  };
  Networks networks;
  while (at < file.size) {
    IntNetwork network;
    network.inputs = next(), network.hidden = next(), network.outputs = next();
    network.predicted = next(), network.shift = next();
    network.w1 = tensor(network.hidden, network.inputs), network.b1 = tensor(network.hidden, 1);
    network.w2 = tensor(network.outputs, network.hidden), network.b2 = tensor(network.outputs, 1);
    network.require_exact();
    networks.push_back(std::make_shared<const IntNetwork>(std::move(network)));
  }
  return networks;
}

Networks load_prior(const ModelSpec &spec) {
  const int number = spec.context.prior;
  const std::string name = "prior " + std::to_string(number);
  if (number != kPrior)
    throw Error(Fault::unsupported, name + " is unknown; this program has prior " + std::to_string(kPrior));
  static const Networks networks = parse_networks(shipped_prior());
  bool fits = networks.size() == coding_steps(spec).size();
  for (size_t step = 0; fits && step < networks.size(); ++step)
    fits = networks[step]->hidden == spec.context.hidden && networks[step]->inputs == input_count(spec, int(step));
  if (!fits) throw Error(Fault::unsupported, name + " does not fit the model that the header describes");
  return networks;
}

}  // namespace sgi
