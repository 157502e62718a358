#include "model/colours.hpp"

#include <cstddef>

namespace sgi {
namespace {

// Of docs/format.md the inverse of A times the opponent colours, as elimination in float64 finds it: numbers, so that
// all machines draw with the same ones.
constexpr double kFromLuma[3][3] = {
    {0x1.6f96f96f96f96p+0, -0x1.5555555555554p-2, -0x1.a41a41a41a40ap-4},
    {-0x1.5015015015008p-6, 0x1.7777777777778p-1, 0x1.2612612612613p-2},
    {-0x1.a41a41a41a40cp-4, -0x1.5555555555556p-2, 0x1.6f96f96f96f97p+0},
};

std::vector<double> identity(int channels) {
  std::vector<double> matrix(size_t(channels) * channels);
  for (int c = 0; c < channels; ++c) matrix[c * channels + c] = 1;
  return matrix;
}

}  // namespace

std::vector<double> colour_matrix(int channels) {
  std::vector<double> matrix = identity(channels);
  if (channels < 3) return matrix;
  constexpr double root2 = 0x1.6a09e667f3bcdp-1, root3 = 0x1.279a74590331cp-1,
                   root6 = 0x1.a20bd700c2c3ep-2;  // reciprocals, rounded to nearest
  const double rows[3][3] = {{root3, root3, root3}, {root2, 0.0, -root2}, {-root6, 2 * root6, -root6}};
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) matrix[r * channels + c] = rows[r][c];
  return matrix;
}

std::vector<double> from_luma_space(int channels) {
  std::vector<double> matrix = identity(channels);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) matrix[r * channels + c] = kFromLuma[r][c];
  return matrix;
}

std::vector<float> texture_mix(int channels, bool luma_space) {
  if (channels < 3) return {};
  const std::vector<double> opponent = colour_matrix(3), into = luma_space ? from_luma_space(3) : identity(3);
  std::vector<float> mix(9);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += opponent[r * 3 + k] * into[c * 3 + k];
      mix[r * 3 + c] = float(sum);
    }
  return mix;
}

std::vector<double> mixed_planes(const std::vector<double> &matrix, bool transposed, const std::vector<double> &values,
                                 int channels, int64_t n) {
  std::vector<double> out(values.size());
  for (int c = 0; c < channels; ++c)
    for (int k = 0; k < channels; ++k) {
      const double share = transposed ? matrix[k * channels + c] : matrix[c * channels + k];
      for (int64_t i = 0; i < n; ++i) out[c * n + i] += share * values[k * n + i];
    }
  return out;
}

}  // namespace sgi
