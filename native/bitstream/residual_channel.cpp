#include "bitstream/residual_channel.hpp"

namespace sgi {

void ResidualChannel::prepare(int64_t x, const std::vector<ResidualChannel> &channels) {
  constexpr int8_t near[kNear][2] = {{0, -1}, {-1, 0}, {-1, -1}, {-1, 1},  {0, -2},
                                     {-2, 0}, {-2, 1}, {-1, 2},  {-2, -1}, {-1, -2}};
  constexpr int8_t other[kOther][2] = {{0, -1}, {-1, 0}, {-1, 1}, {-1, -1}};
  int count = 0;
  const auto add = [&](int32_t value) { values_[size_t(count++)] = float(value); };
  const KnownValue *here = at(x);
  for (const auto &[down, across] : near) add(here[down * stride + across].difference);
  for (const int32_t slope : slopes_) add(slope);
  for (int k = place - others(place); k < place; ++k) {
    const KnownValue *there = channels[size_t(k)].at(x);
    for (const auto &[down, across] : other) add(there[down * stride + across].difference);
  }
  if (place)
    for (const int32_t slope : channels[size_t(place - 1)].slopes_) add(slope);
  const int32_t left = here[-1].value, above = here[-stride].value, plane = left + above - here[-stride - 1].value;
  add(std::clamp(plane, std::min(left, above), std::max(left, above)) - drawn_);
  early_ = count;
  predicted_ = predictor_.predict(values_.data(), 0, early_, 0);
}

// The weights where nothing is known: a plane through the neighbours, and the difference of the channel before.
std::vector<double> ResidualChannel::prior(int place) {
  const int count = kNear + kDrawn + others(place) * (kOther + 1) + (place ? kDrawn : 0) + 1;
  std::vector<double> weights(size_t(count), 0.0);
  weights[0] = 0.4, weights[1] = 0.45, weights[2] = -0.15, weights[3] = 0.1;
  if (place) weights.back() = 0.8;
  return weights;
}

}  // namespace sgi
