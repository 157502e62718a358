#include "bitstream/bit_model.hpp"

#include <cmath>

namespace sgi {

namespace {

constexpr int kMin = 16;  // of a probability

}  // namespace

const BitTables kBitTables;

BitTables::BitTables() {
  for (int i = 0; i < kLogits; ++i) {
    const double p = (i + 0.5) / kLogits;
    logit[i] = int16_t(std::lrint(256 * std::log(p / (1 - p))));
  }
  for (int i = 0; i < 2 * kLogisticHalf; ++i) {
    const double p = kCertain / (1 + std::exp((kLogisticHalf - i) / 256.0));
    logistic[i] = uint16_t(std::clamp(int(std::lrint(p)), kMin, kCertain - 1 - kMin));
  }
  for (int i = 0; i <= kSeenLimit; ++i) rate[i] = 10 * kCertain / (10 * i + 16);
  for (int i = 0; i <= kLogits; ++i) cost[i] = float(-std::log2(std::max(i, 1) / double(kLogits)));
}

}  // namespace sgi
