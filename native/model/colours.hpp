// Colours of models: opponent channels, luma space (docs/format.md, "Drawing").
#pragma once
#include <cstdint>
#include <vector>

namespace sgi {

// [C, C]; rows: one opponent channel each as a mix of the picture's channels.
std::vector<double> colour_matrix(int channels);
// [C, C]; what takes samples of luma space, any others behind them, to red, green and blue.
std::vector<double> from_luma_space(int channels);
// [3, 3], as `draw_texture` takes it: texture's opponent channels to the picture's; null for fewer than three.
std::vector<float> texture_mix(int channels, bool luma_space);

// matrix [C, C], or its transpose, times values [C, n].
std::vector<double> mixed_planes(const std::vector<double> &matrix, bool transposed, const std::vector<double> &values,
                                 int channels, int64_t n);

}  // namespace sgi
