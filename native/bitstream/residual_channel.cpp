#include "bitstream/residual_channel.hpp"

namespace sgi {

void ResidualChannel::prepare(int64_t x, const std::vector<ResidualChannel> &channels) {
  float *to = values_.data();
  const auto add = [&](const float *from, int count) { to = std::copy_n(from, count, to); };
  const float *near = difference(x);
  add(near - 2, 2), add(near - stride - 2, 5), add(near - 2 * stride - 1, 3);
  add(slopes_.data(), kDrawn);
  for (int k = place - others(place); k < place; ++k) {
    const float *there = channels[size_t(k)].difference(x);
    add(there - 1, 1), add(there - stride - 1, 3);
  }
  if (place) add(channels[size_t(place - 1)].slopes_.data(), kDrawn);
  const KnownValue *here = at(x);
  const int32_t left = here[-1].value, above = here[-stride].value, plane = left + above - here[-stride - 1].value;
  *to++ = float(std::clamp(plane, std::min(left, above), std::max(left, above)) - drawn_);
  early_ = int(to - values_.data());
  std::fill(to, values_.data() + kPredictorRow, 0.0f);
  predicted_ = predictor_.predict(values_.data());
}

// The weights where nothing is known: a plane through the neighbours, and the difference of the channel before.
std::vector<double> ResidualChannel::prior(int place) {
  const int count = kNear + kDrawn + others(place) * (kOther + 1) + (place ? kDrawn : 0) + 1;
  std::vector<double> weights(size_t(count), 0.0);
  weights[1] = 0.4, weights[4] = 0.45, weights[3] = -0.15, weights[5] = 0.1;
  if (place) weights.back() = 0.8;
  return weights;
}

}  // namespace sgi
