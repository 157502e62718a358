#include "bitstream/restoration_part.hpp"

#include <string>

#include "base/error.hpp"
#include "bitstream/shipped.hpp"

namespace sgi {
namespace {

constexpr int kNetworkBits = 4, kStepBits = 9;

// By number.
template <int kNumber>
const std::shared_ptr<const RestorationNetwork> &parsed() {
  static const auto network =
      std::make_shared<const RestorationNetwork>(parse_restoration(shipped_restoration(kNumber)));
  return network;
}

}  // namespace

const SharedNetwork &restoration_network(int number, const SharedNetwork &own) {
  if (number == 1) return parsed<1>();
  if (number == 2) return parsed<2>();
  if (number == kOwnNetwork) {
    if (!own) throw Error(Fault::corrupt, "restoration: a network of its own that the picture does not have");
    return own;
  }
  throw Error(Fault::unsupported,
              "restoration: network " + std::to_string(number) + "; this program has networks 1 and 2");
}

template <class Coder>
void code_restoration_part(Coder &coder, const SharedNetwork &own, RestorationChoice &choice) {
  coder.number(kNetworkBits, choice.network);
  if (!choice.network) return;
  if (Coder::kReads) restoration_network(choice.network, own);
  coder.number(kStepBits, choice.step);
}

template void code_restoration_part(SymbolReader &coder, const SharedNetwork &own, RestorationChoice &choice);
template void code_restoration_part(SymbolWriter &coder, const SharedNetwork &own, RestorationChoice &choice);

}  // namespace sgi
