#include "bitstream/residual_channel.hpp"

#include <cstring>

namespace sgi {

namespace {

// Appends a few numbers, whose count the compiler knows: a call to copy them takes longer than that.
template <int count>
void append(float *&to, const float *from) {
  std::memcpy(to, from, sizeof(float) * count);
  to += count;
}

}  // namespace

void ResidualChannel::prepare(int64_t x, const std::vector<ResidualChannel> &channels) {
  float *to = values_.data();
  const float *near = difference(x);
  append<2>(to, near - 2), append<5>(to, near - stride - 2), append<3>(to, near - 2 * stride - 1);
  append<kDrawn>(to, slopes_.data());
  for (int k = place - others(place); k < place; ++k) {
    const float *there = channels[size_t(k)].difference(x);
    append<1>(to, there - 1), append<3>(to, there - stride - 1);
  }
  if (place) append<kDrawn>(to, channels[size_t(place - 1)].slopes_.data());
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
