#include "model/base_view.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int kSamplesPerCell = 4;  // how densely the area of a pixel is sampled that covers cells

// For each output pixel the first cell, and the weights [count, taps] of it and those after. Cells may lie outside the
// grid: those of its edges stand for them.
struct Footprints {
  std::vector<int64_t> first;
  std::vector<double> weights;
  int taps;
};

// Catmull-Rom weights of the four cells around a place, which lies `behind` the centre of the second one.
void add_cubic(double behind, double *weights, double share) {
  const double at = behind + 1.5 - 0.5;
  const int64_t first = int64_t(std::floor(at));
  double taps[4] = {};
  for (int64_t tap = -1; tap < 3; ++tap) {
    const double d = std::abs(at - double(first + tap));
    const double near = (1.5 * d - 2.5) * d * d + 1.0, far = ((-0.5 * d + 2.5) * d - 4.0) * d + 2.0;
    taps[std::clamp<int64_t>(first + tap, 0, 3)] += d <= 1 ? near : d < 2 ? far : 0;
  }
  for (int tap = 0; tap < 4; ++tap) weights[tap] += taps[tap] / share;
}

Footprints footprints(const OutputAxis &axis, int cell) {
  const int samples = std::max(1, int(std::ceil(kSamplesPerCell / (axis.scale * cell))));
  const auto place = [&](int64_t i, int sample) {  // in cells
    return axis.place(i, (sample + 0.5) / samples) / cell - 0.5;
  };
  const auto lowest = [&](int64_t i, int sample) { return int64_t(std::floor(place(i, sample))); };
  Footprints found{std::vector<int64_t>(axis.count), {}, 4};
  for (int64_t i = 0; i < axis.count; ++i) {
    const int64_t begin = lowest(i, 0);
    found.first[i] = begin - 1;
    found.taps = std::max(found.taps, int(lowest(i, samples - 1) - begin) + 4);
  }
  found.weights.resize(axis.count * found.taps);
  for (int64_t i = 0; i < axis.count; ++i)
    for (int sample = 0; sample < samples; ++sample) {
      const double at = place(i, sample), low = std::floor(at);
      add_cubic(at - low, &found.weights[i * found.taps + (int64_t(low) - 1 - found.first[i])], samples);
    }
  return found;
}

// lines [C, count, width]: row first + i of the grid interpolated at each output column; beyond its edges it repeats.
// Each term is added in float64 and the sum rounded to float32.
void write_lines(const BaseGrid &grid, int64_t first, int64_t count, const Footprints &across, int threads,
                 std::vector<float> &lines) {
  const auto width = int64_t(across.first.size());
  lines.resize(size_t(grid.channels * count * width));
  parallel_for(grid.channels * count, threads, [&](int64_t i) {
    const int64_t row = std::clamp<int64_t>(first + i % count, 0, grid.rows - 1);
    const double *cells = grid.values + (i / count * grid.rows + row) * grid.columns;
    const double *weight = across.weights.data();
    for (int64_t x = 0; x < width; ++x) {
      float sum = 0;
      for (int64_t cell = across.first[size_t(x)], end = cell + across.taps; cell < end; ++cell) {
        const double term = cells[std::clamp<int64_t>(cell, 0, grid.columns - 1)] * *weight++;
        sum = float(double(sum) + term);
      }
      lines[size_t(i * width + x)] = sum;
    }
  });
}

}  // namespace

BaseView base_view(const BaseGrid &grid, int cell, const OutputAxis &x, const OutputAxis &y, int threads) {
  const Footprints across = footprints(x, cell), down = footprints(y, cell);
  const int64_t first = down.first.front(), count = down.first.back() - first + down.taps;
  BaseView view{{}, {}, {}, count, down.taps};
  write_lines(grid, first, count, across, threads, view.lines);
  for (const int64_t row : down.first) view.top.push_back(int32_t(row - first));
  view.down.assign(down.weights.begin(), down.weights.end());
  return view;
}

}  // namespace sgi
