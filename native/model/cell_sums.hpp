// Sums of samples over the smallest quadtree cells, from which those of all larger cells follow.
#pragma once
#include <cstdint>

namespace sgi {

constexpr int kSmallestCell = 2;  // pixels of its side

// detail [channels, height, width]; weights [height, width] of its pixels, nullptr where all are 1.
struct WeightedSamples {
  const float *detail, *weights;
  int64_t channels, height, width;
};

// Of each cell [rows, columns]: the sum of weight * detail by channel [channels, rows, columns], of weight * detail^2
// over channels, and of the weights. Cells may reach beyond the samples, which go on as zeros with the border's
// weights.
void cell_sums(const WeightedSamples &samples, int64_t rows, int64_t columns, int threads, double *values,
               double *squares, double *weights);

}  // namespace sgi
