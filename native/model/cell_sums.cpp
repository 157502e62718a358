#include "model/cell_sums.hpp"

#include <algorithm>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

// Rows of cells of one level.
class CellRow {
 public:
  CellRow(const WeightedSamples &samples, int64_t row, int64_t columns)
      : s_(samples), top_(row * kSmallestCell), columns_(columns) {}

  // Adds the weights of the cells.
  void weigh(double *weights) const {
    for (int i = 0; i < kSmallestCell; ++i) {
      const float *line = s_.weights ? s_.weights + std::min(top_ + i, s_.height - 1) * s_.width : nullptr;
      const int64_t whole = line ? std::min(columns_, s_.width / kSmallestCell) : 0;
      for (int64_t c = 0; c < whole; ++c) weights[c] += double(line[2 * c]) + double(line[2 * c + 1]);
      for (int64_t c = whole; c < columns_; ++c)
        for (int64_t x = 2 * c; x < 2 * c + kSmallestCell; ++x)
          weights[c] += line ? double(line[std::min(x, s_.width - 1)]) : 1.0;
    }
  }

  // Adds the samples of a channel and their squares.
  void add(int64_t channel, double *values, double *squares) const {
    for (int i = 0; i < kSmallestCell && top_ + i < s_.height; ++i) {
      const float *line = s_.detail + (channel * s_.height + top_ + i) * s_.width;
      if (s_.weights)
        add_line(line, s_.weights + (top_ + i) * s_.width, values, squares);
      else
        add_line(line, Ones(), values, squares);
    }
  }

 private:
  struct Ones {
    double operator[](int64_t) const { return 1.0; }
  };

  template <class Weights>
  void add_line(const float *line, const Weights &weights, double *values, double *squares) const {
    const int64_t whole = s_.width / kSmallestCell;
    for (int64_t c = 0; c < whole; ++c) {
      const double first = line[2 * c], second = line[2 * c + 1];
      const double held = first * double(weights[2 * c]), other = second * double(weights[2 * c + 1]);
      values[c] += held + other;
      squares[c] += held * first + other * second;
    }
    if (s_.width % kSmallestCell) {
      const double last = line[s_.width - 1], held = last * double(weights[s_.width - 1]);
      values[whole] += held;
      squares[whole] += held * last;
    }
  }

  const WeightedSamples &s_;
  const int64_t top_, columns_;
};

// Sums over four cells of planes below.
std::vector<double> of_larger(const std::vector<double> &below, int64_t planes, int64_t rows, int64_t columns) {
  std::vector<double> sums(size_t(planes * rows * columns));
  for (int64_t r = 0; r < planes * rows; ++r) {
    const double *upper = &below[size_t(4 * r * columns)], *lower = upper + 2 * columns;
    double *to = &sums[size_t(r * columns)];
    for (int64_t c = 0; c < columns; ++c) to[c] = (upper[2 * c] + lower[2 * c]) + (upper[2 * c + 1] + lower[2 * c + 1]);
  }
  return sums;
}

}  // namespace

std::vector<CellSums> cell_sums(const WeightedSamples &samples, int root_log, int threads) {
  constexpr int64_t kChunk = 8;
  const int64_t side = int64_t(1) << root_log;
  const int64_t rows = (samples.height + side - 1) / side * side / kSmallestCell;
  const int64_t columns = (samples.width + side - 1) / side * side / kSmallestCell;
  const auto cells = size_t(rows * columns);
  std::vector<CellSums> levels;
  levels.reserve(size_t(root_log));
  CellSums &least = levels.emplace_back(CellSums{rows, columns, std::vector<double>(size_t(samples.channels) * cells),
                                                 std::vector<double>(cells), std::vector<double>(cells)});
  parallel_for((rows + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    for (int64_t r = chunk * kChunk; r < std::min(rows, (chunk + 1) * kChunk); ++r) {
      const CellRow row(samples, r, columns);
      row.weigh(&least.weights[size_t(r * columns)]);
      for (int64_t c = 0; c < samples.channels; ++c)
        row.add(c, &least.values[size_t((c * rows + r) * columns)], &least.squares[size_t(r * columns)]);
    }
  });
  while (int(levels.size()) < root_log) {
    const CellSums &below = levels.back();
    const int64_t down = below.rows / 2, across = below.columns / 2;
    levels.push_back({down, across, of_larger(below.values, samples.channels, down, across),
                      of_larger(below.squares, 1, down, across), of_larger(below.weights, 1, down, across)});
  }
  return levels;
}

}  // namespace sgi
