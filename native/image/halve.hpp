// A plane at half its size.
#pragma once
#include <cstdint>

namespace sgi {

// half [channels, ceil(height / 2), ceil(width / 2)] of planes [channels, height, width], filtered with (1, 3, 3, 1) /
// 8 along both axes; edges are repeated.
void halve(const float *planes, int64_t channels, int64_t height, int64_t width, float *half);

}  // namespace sgi
