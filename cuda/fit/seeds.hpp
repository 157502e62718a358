// Seeds that come and go: what each holds, what the picture still lacks, and rows that move.
#pragma once
#include "base/scalar.hpp"
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"
#include "model/cell_sums.hpp"

namespace sgi {

constexpr int kRowThreads = 256;

// energy [count]: squared samples that the Gaussian of each seed would draw alone, over the plane, as
// SeedSet.energy (sgicodec/fit/seed_set.py) without weights.
SGI_KERNEL(measure_energy, kRowThreads, EnergyArguments) {
  block.each([&](int t) {
    const int seed = block.index() * kRowThreads + t;
    if (seed >= a.count) return;
    const float *covariance = a.covariances + 3 * int64_t(seed), *colour = a.colours + int64_t(seed) * a.channels;
    const float determinant = covariance[0] * covariance[2] - covariance[1] * covariance[1];
    float squares = 0.0f;
    for (int c = 0; c < a.channels; ++c) squares += colour[c] * colour[c];
    a.energy[seed] = 3.14159265f * rootv(maxv(determinant, 1e-9f)) * squares;
  });
}

// to [count, width]: rows of `source` by number, and for -1 - i row i of `fresh`, zeros where there are none.
SGI_KERNEL(move_rows, kRowThreads, RowArguments) {
  block.each([&](int t) {
    const int64_t at = int64_t(block.index()) * kRowThreads + t;
    if (at >= int64_t(a.count) * a.width) return;
    const int row = a.rows[at / a.width];
    const int64_t column = at % a.width;
    if (row >= 0)
      a.to[at] = a.source[int64_t(row) * a.width + column];
    else
      a.to[at] = a.fresh ? a.fresh[int64_t(-1 - row) * a.width + column] : 0.0f;
  });
}

// sums [channels, rows, columns]: of weight * (target - image) over the smallest cells, which may reach beyond both, as
// `cell_sums` of native/model.
SGI_KERNEL(sum_residual, kRowThreads, ResidualArguments) {
  block.each([&](int t) {
    const int64_t at = int64_t(block.index()) * kRowThreads + t;
    if (at >= int64_t(a.channels) * a.rows * a.columns) return;
    const int channel = int(at / a.columns / a.rows);
    const int top = int(at / a.columns % a.rows) * kSmallestCell, left = int(at % a.columns) * kSmallestCell;
    double sum = 0;
    for (int y = top; y < top + kSmallestCell && y < a.height; ++y)
      for (int x = left; x < left + kSmallestCell && x < a.width; ++x) {
        const int64_t pixel = int64_t(y) * a.width + x, sample = int64_t(channel) * a.height * a.width + pixel;
        const float lacks = a.target[sample] - a.image[sample];
        sum += (a.weights ? double(a.weights[pixel]) : 1.0) * lacks;
      }
    a.sums[at] = float(sum);
  });
}

}  // namespace sgi
