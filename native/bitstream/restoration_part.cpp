#include "bitstream/restoration_part.hpp"

#include <string>
#include <vector>

#include "base/error.hpp"
#include "bitstream/arrays.hpp"
#include "bitstream/shipped.hpp"

namespace sgi {
namespace {

constexpr int kNetworkBits = 4, kStepBits = 9, kUnitBits = 3, kChanged = 8;

// By number.
template <int kNumber>
const std::shared_ptr<const RestorationNetwork> &parsed() {
  static const auto network =
      std::make_shared<const RestorationNetwork>(parse_restoration(shipped_restoration(kNumber)));
  return network;
}

const std::shared_ptr<const RestorationNetwork> &shipped(int number) {
  if (number == 1) return parsed<1>();
  if (number == 3) return parsed<3>();
  throw Error(Fault::unsupported,
              "restoration: network " + std::to_string(number) + "; this program has networks 1 and 3");
}

LayerChange read_change(SymbolReader &reader, const RestorationLayer &layer) {
  const int unit = reader.number(kUnitBits);
  LayerChange change;
  for (int output = 0; unit && output < layer.outputs; ++output)
    for (const int64_t value : read_weights(reader, int64_t(layer.inputs) * kRestorationTaps + 1))
      change.push_back(int32_t(value * (int64_t(1) << (unit - 1))));
  return change;
}

}  // namespace

std::shared_ptr<const RestorationNetwork> restoration_network(const RestorationChoice &choice) {
  const std::shared_ptr<const RestorationNetwork> &network = shipped(choice.network);
  if (choice.changes.empty()) return network;
  return std::make_shared<const RestorationNetwork>(changed(*network, choice.changes));
}

RestorationChoice read_restoration_part(SymbolReader &reader) {
  RestorationChoice choice;
  const int stated = reader.number(kNetworkBits);
  if (!stated) return choice;
  choice.network = stated % kChanged;
  const RestorationNetwork &network = *shipped(choice.network);
  choice.step = reader.number(kStepBits);
  if (stated < kChanged) return choice;
  for (const RestorationLayer &layer : network.layers) choice.changes.push_back(read_change(reader, layer));
  restoration_network(choice);
  return choice;
}

}  // namespace sgi
