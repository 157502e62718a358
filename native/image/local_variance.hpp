// The variance of a plane around each pixel.
#pragma once
#include <cstdint>

namespace sgi {

// variance [height, width] of plane [height, width] in the square window that reaches `radius` pixels to all sides, as
// far as it lies in the plane.
void local_variance(const double *plane, int64_t height, int64_t width, int radius, double *variance);

}  // namespace sgi
