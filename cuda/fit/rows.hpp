// Layers of networks over rows of what seeds have, [rows, count]: neighbouring threads have neighbouring seeds.
#pragma once
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"

namespace sgi {

constexpr int kProductThreads = 128, kProductRows = 8;
constexpr int kSumSide = 16, kSumThreads = 256, kSumSeeds = 32;
static_assert(kSumThreads == kSumSide * kSumSide, "a thread has a sum");

// A thread has a seed and kProductRows rows; a block's index is that of its seeds, then of its rows.
SGI_KERNEL(multiply_rows, kProductThreads, ProductArguments) {
  const int groups = (a.rows + kProductRows - 1) / kProductRows;
  const int first = block.index() % groups * kProductRows;
  const auto row_at = [&](int i) { return first + i < a.rows ? first + i : a.rows - 1; };
  block.each([&](int t) {
    const int seed = block.index() / groups * kProductThreads + t;
    if (seed >= a.count) return;
    float sum[kProductRows];
    for (int i = 0; i < kProductRows; ++i) sum[i] = a.bias ? a.bias[row_at(i)] : 0.0f;
    for (int c = 0; c < a.columns; ++c) {
      const float x = a.input[int64_t(c) * a.count + seed];
      for (int i = 0; i < kProductRows; ++i) sum[i] += a.weights[row_at(i) * a.row_step + c * a.column_step] * x;
    }
    for (int i = 0; i < kProductRows && first + i < a.rows; ++i) {
      const int64_t at = int64_t(first + i) * a.count + seed;
      float value = a.adds ? a.out[at] + sum[i] : sum[i];
      if (a.clips) value = maxv(value, 0.0f);
      if (a.passes && !(a.passes[at] > 0.0f)) value = 0.0f;
      a.out[at] = value;
    }
  });
}

namespace {

// Sum i of partials [chunks, width], in the order of chunks.
inline float sum_of_chunks(const float *partials, int chunks, int width, int i) {
  double sum = 0;
  for (int chunk = 0; chunk < chunks; ++chunk) sum += partials[int64_t(chunk) * width + i];
  return float(sum);
}

struct SumMemory {
  float up[kSumSeeds][kSumSide + 1], input[kSumSeeds][kSumSide + 1];  // odd rows share no banks
};

}  // namespace

// A block has kSumSide rows and as many columns, and a chunk of seeds, in their order; the column behind the last is
// that of the bias. Its index is that of its chunk, then of its rows, then of its columns.
SGI_KERNEL(sum_products, kSumThreads, SumArguments) {
  SGI_SHARED(SumMemory, memory);
  PerThread<float, kSumThreads> sum;
  const int across = (a.columns + kSumSide) / kSumSide, down = (a.rows + kSumSide - 1) / kSumSide;
  const int first_column = block.index() % across * kSumSide, first_row = block.index() / across % down * kSumSide;
  const int chunk = block.index() / across / down, begin = chunk * a.chunk;
  const int end = begin + a.chunk < a.count ? begin + a.chunk : a.count;
  block.each([&](int t) { sum[t] = 0.0f; });
  for (int seed = begin; seed < end; seed += kSumSeeds) {
    block.each([&](int t) {
      for (int i = t; i < kSumSide * kSumSeeds; i += kSumThreads) {
        const int n = i % kSumSeeds, row = first_row + i / kSumSeeds, column = first_column + i / kSumSeeds;
        const bool live = seed + n < end;
        memory.up[n][i / kSumSeeds] = live && row < a.rows ? a.up[int64_t(row) * a.count + seed + n] : 0.0f;
        memory.input[n][i / kSumSeeds] =
            live && column < a.columns ? a.input[int64_t(column) * a.count + seed + n] : 1.0f;
      }
    });
    block.each([&](int t) {
      for (int n = 0; n < kSumSeeds; ++n) sum[t] += memory.up[n][t / kSumSide] * memory.input[n][t % kSumSide];
    });
  }
  block.each([&](int t) {
    const int row = first_row + t / kSumSide, column = first_column + t % kSumSide;
    if (row >= a.rows || column > a.columns) return;
    const int at = column < a.columns ? a.weights_at + row * a.row_step + column : a.bias_at + row;
    a.partials[int64_t(chunk) * a.width + at] = sum[t];
  });
}

SGI_KERNEL(sum_partials, kProductThreads, SumArguments) {
  block.each([&](int t) {
    const int i = block.index() * kProductThreads + t;
    if (i < a.width) a.sums[i] = sum_of_chunks(a.partials, a.chunks, a.width, i);
  });
}

}  // namespace sgi
