#include "bitstream/bit_model.hpp"

#include <cmath>

namespace sgi {

const BitTables kBitTables;

BitTables::BitTables() {
  for (int i = 0; i < 2 * kLogisticHalf; ++i) {
    const double p = kCertain / (1 + std::exp((kLogisticHalf - i) / 256.0));
    logistic[size_t(i)] = uint16_t(std::clamp(int(std::lrint(p)), kLeastP, kCertain - 1 - kLeastP));
  }
  for (int i = 0; i <= int(kSteady); ++i) rate[size_t(i)] = 6 * kCertain / (i + 16);
  for (int i = 0; i <= kCosts; ++i) cost[size_t(i)] = float(-std::log2(std::max(i, 1) / double(kCosts)));
}

}  // namespace sgi
