#include "model/cell_sums.hpp"

#include <algorithm>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

// One row of cells.
class CellRow {
 public:
  CellRow(const WeightedSamples &samples, int64_t row, int64_t columns)
      : s_(samples), top_(row * kSmallestCell), columns_(columns) {}

  // Adds the weights of the cells, and returns them.
  void weigh(double *weights) const {
    for (int64_t c = 0; c < columns_; ++c)
      for (int i = 0; i < kSmallestCell; ++i)
        for (int j = 0; j < kSmallestCell; ++j) weights[c] += weight(top_ + i, c * kSmallestCell + j);
  }

  // Adds the samples of a channel and their squares.
  void add(int64_t channel, double *values, double *squares) const {
    for (int i = 0; i < kSmallestCell && top_ + i < s_.height; ++i) {
      const float *line = s_.detail + (channel * s_.height + top_ + i) * s_.width;
      const float *weights = s_.weights ? s_.weights + (top_ + i) * s_.width : nullptr;
      const auto take = [&](int64_t x, int64_t c) {
        const double held = (weights ? double(weights[x]) : 1.0) * line[x];
        values[c] += held;
        squares[c] += held * line[x];
      };
      const int64_t whole = std::min(columns_, s_.width / kSmallestCell);
      for (int64_t c = 0; c < whole; ++c)
        for (int j = 0; j < kSmallestCell; ++j) take(c * kSmallestCell + j, c);
      for (int64_t x = whole * kSmallestCell; x < s_.width; ++x) take(x, whole);
    }
  }

 private:
  double weight(int64_t y, int64_t x) const {
    return s_.weights ? s_.weights[std::min(y, s_.height - 1) * s_.width + std::min(x, s_.width - 1)] : 1.0;
  }

  const WeightedSamples &s_;
  const int64_t top_, columns_;
};

}  // namespace

void cell_sums(const WeightedSamples &samples, int64_t rows, int64_t columns, int threads, double *values,
               double *squares, double *weights) {
  constexpr int64_t kChunk = 8;
  std::fill_n(values, samples.channels * rows * columns, 0.0);
  std::fill_n(squares, rows * columns, 0.0);
  std::fill_n(weights, rows * columns, 0.0);
  parallel_for((rows + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    for (int64_t r = chunk * kChunk; r < std::min(rows, (chunk + 1) * kChunk); ++r) {
      const CellRow row(samples, r, columns);
      row.weigh(weights + r * columns);
      for (int64_t c = 0; c < samples.channels; ++c)
        row.add(c, values + (c * rows + r) * columns, squares + r * columns);
    }
  });
}

}  // namespace sgi
