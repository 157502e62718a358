// Sums of samples over the cells of a quadtree.
#pragma once
#include <cstdint>
#include <vector>

namespace sgi {

constexpr int kSmallestCell = 2;  // pixels of its side

// detail [channels, height, width]; weights [height, width] of its pixels, nullptr where all are 1.
struct WeightedSamples {
  const float *detail, *weights;
  int64_t channels, height, width;
};

// Of each cell [rows, columns] of a level: the sum of weight * detail by channel [channels, rows, columns], of weight *
// detail^2 over channels, and of the weights. Cells may reach beyond the samples, which go on as zeros with the
// border's weights.
struct CellSums {
  int64_t rows, columns;
  std::vector<double> values, squares, weights;
};

// Of levels 1 ... root_log, whose cells have 2^level pixels along a side; as many as whole roots have.
std::vector<CellSums> cell_sums(const WeightedSamples &samples, int root_log, int threads);

}  // namespace sgi
