// Regular patterns of a plane: stripes, ribs, slats, rows of stitches.
#pragma once
#include <cstdint>

#include "image/regular_pattern_kernel.hpp"

namespace sgi {

// The pattern that stands out most in each of rows by columns blocks; ratio, power, number [rows, columns]: as in
// RegularPatternKernel. plane [height, width]: with what lies around the blocks, at least to the end of the last
// LANES of them.
void find_regular_patterns(const Patterns &patterns, const float *plane, int64_t width, int64_t rows, int64_t columns,
                           int threads, Isa isa, float *ratio, float *power, int32_t *number);

}  // namespace sgi
