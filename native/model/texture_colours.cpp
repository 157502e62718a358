#include "model/texture_colours.hpp"

#include <cstddef>

#include "base/exact.hpp"

namespace sgi {

std::array<double, 9> TextureColours::matrix() const {
  const double angle = (turn - kSameTurn) / 32.0, cosine = cosine_pi(angle), sine = sine_pi(angle);
  return {1, 0, 0, (shares[0] - kSameShare) / 64.0, cosine, -sine, (shares[1] - kSameShare) / 64.0, sine, cosine};
}

std::array<double, 9> TextureColours::inverse() const {
  const auto [one, no, none, share_one, cosine, minus_sine, share_two, sine, same] = matrix();
  return {1,     0,     0, -cosine * share_one - sine * share_two, cosine, sine, sine * share_one - cosine * share_two,
          -sine, cosine};
}

std::array<double, 9> transposed(const std::array<double, 9> &matrix) {
  const std::array<double, 9> &m = matrix;
  return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]};
}

void mix_colours(const std::array<double, 9> &matrix, float *planes, int64_t plane, int64_t count) {
  std::array<float, 9> mix;
  for (size_t i = 0; i < mix.size(); ++i) mix[i] = float(matrix[i]);
  for (int64_t i = 0; i < count; ++i) {
    const float first = planes[i], second = planes[plane + i], third = planes[2 * plane + i];
    planes[i] = mix[0] * first + mix[1] * second + mix[2] * third;
    planes[plane + i] = mix[3] * first + mix[4] * second + mix[5] * third;
    planes[2 * plane + i] = mix[6] * first + mix[7] * second + mix[8] * third;
  }
}

}  // namespace sgi
