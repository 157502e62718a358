#include "bitstream/texture_models.hpp"

#include <algorithm>
#include <cmath>

namespace sgi {

namespace {

constexpr int kMin = 16;            // of a probability
constexpr int kWeightSum = 144179;  // of a context's weights at first, in 2^-16: 2.2

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
  rate[kSeenLimit + 1] = 0;
  for (int i = 0; i <= kLogits; ++i) cost[i] = float(-std::log2(std::max(i, 1) / double(kLogits)));
}

BitModels::BitModels(int64_t models, int64_t sets) : models_(models, BitModel{kCertain / 2, 0}) {
  models_.push_back({kCertain / 2, kSeenLimit + 1});
  weights_.assign(sets * kMaxMixed, kWeightSum / kMaxMixed);
}

std::vector<uint8_t> BitModels::state() const {
  std::vector<uint8_t> bytes;
  const auto models = size_t(count());
  bytes.reserve(3 * models + 4 * weights_.size());
  for (size_t i = 0; i < models; ++i) bytes.push_back(uint8_t(models_[i].probability & 255));
  for (size_t i = 0; i < models; ++i) bytes.push_back(uint8_t(models_[i].probability >> 8));
  for (size_t i = 0; i < models; ++i) bytes.push_back(models_[i].seen);
  for (const int32_t weight : weights_)
    for (int byte = 0; byte < 4; ++byte) bytes.push_back(uint8_t(uint32_t(weight) >> (8 * byte)));
  return bytes;
}

bool BitModels::set_state(const uint8_t *bytes, int64_t size) {
  const auto models = count(), weights = int64_t(weights_.size());
  if (size != 3 * models + 4 * weights) return false;
  for (int64_t i = 0; i < models; ++i) {
    models_[i].probability = uint16_t(bytes[i] | bytes[models + i] << 8);
    models_[i].seen = std::min<uint8_t>(bytes[2 * models + i], kSeenLimit);
  }
  for (int64_t i = 0; i < weights; ++i) {
    const uint8_t *w = bytes + 3 * models + 4 * i;
    const uint32_t value = uint32_t(w[0]) | uint32_t(w[1]) << 8 | uint32_t(w[2]) << 16 | uint32_t(w[3]) << 24;
    weights_[i] = std::clamp(int32_t(value), -kWeightLimit, kWeightLimit);
  }
  return true;
}

void BitModels::settle(int most) {
  for (int64_t i = 0; i < count(); ++i) models_[i].seen = uint8_t(std::min(int(models_[i].seen), most));
}

}  // namespace sgi
