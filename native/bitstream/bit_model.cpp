#include "bitstream/bit_model.hpp"

#include <algorithm>
#include <cmath>

namespace sgi {

const BitTables kBitTables;

BitTables::BitTables() {
  constexpr int kHalf = 1 << (kLogitBits - 1);
  for (int i = -kHalf; i < kHalf; ++i) {
    const double p = kCertain / (1 + std::exp(-std::clamp(i, -kMaxLogit, kMaxLogit - 1) / 256.0));
    logistic[size_t(i & (2 * kHalf - 1))] = uint16_t(std::clamp(int(std::lrint(p)), kMinP, kCertain - 1 - kMinP));
  }
  for (int i = 0; i <= int(kSteady); ++i) rate[size_t(i)] = 6 * kCertain / (i + 16);
  for (int i = 0; i <= kCosts; ++i) cost[size_t(i)] = float(-std::log2(std::max(i, 1) / double(kCosts)));
}

}  // namespace sgi
