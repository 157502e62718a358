#include "model/base_lines.hpp"

#include <algorithm>

#include "base/thread_pool.hpp"

namespace sgi {

void base_lines(const BaseGrid &grid, int64_t first, int64_t count, const int64_t *left, const double *across,
                int64_t width, int taps, int threads, float *lines) {
  parallel_for(grid.channels * count, threads, [&](int64_t i) {
    const int64_t row = std::clamp<int64_t>(first + i % count, 0, grid.rows - 1);
    const double *cells = grid.values + (i / count * grid.rows + row) * grid.columns;
    float *line = lines + i * width;
    for (int64_t x = 0; x < width; ++x) {
      float sum = 0;
      for (int t = 0; t < taps; ++t) {
        const double term = cells[std::clamp<int64_t>(left[x] + t, 0, grid.columns - 1)] * across[x * taps + t];
        sum = float(double(sum) + term);
      }
      line[x] = sum;
    }
  });
}

}  // namespace sgi
