#include "bitstream/restoration_part.hpp"

#include <array>
#include <mutex>
#include <string>

#include "base/error.hpp"
#include "bitstream/shipped.hpp"

namespace sgi {
namespace {

constexpr int kNetworkBits = 4, kStepBits = 9, kNetworks = 2;

}  // namespace

const RestorationNetwork &restoration_network(int number) {
  if (number < 1 || number > kNetworks)
    throw Error(Fault::unsupported,
                "restoration: network " + std::to_string(number) + "; this program has networks 1 and 2");
  static std::array<std::once_flag, kNetworks> once;
  static std::array<RestorationNetwork, kNetworks> all;
  const auto index = size_t(number - 1);
  std::call_once(once[index], [&] { all[index] = parse_restoration(shipped_restoration(number)); });
  return all[index];
}

RestorationChoice read_restoration_part(SymbolReader &reader) {
  RestorationChoice choice;
  choice.network = reader.number(kNetworkBits);
  if (!choice.network) return choice;
  restoration_network(choice.network);
  choice.step = reader.number(kStepBits);
  return choice;
}

}  // namespace sgi
