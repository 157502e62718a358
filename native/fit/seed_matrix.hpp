// Products of matrices with what a batch of seeds has: rows of kPitch floats, of which the first kBatchSeeds count, a
// seed in each column.
#pragma once
#include "base/horizontal_sums.hpp"
#include "base/vector.hpp"
#include "fit/feature_kernel.hpp"

namespace sgi {
namespace {

constexpr int kVectors = kBatchSeeds / LANES;

// Element (r, c) is at[r * row_step + c * column_step].
struct Matrix {
  const float *at;
  int rows, columns, row_step, column_step;

  Matrix turned() const { return {at, columns, rows, column_step, row_step}; }
};

// out[r] = bias[r], 0 without any.
inline void fill(const float *bias, int rows, float *out) {
  for (int r = 0; r < rows; ++r)
    for (int v = 0; v < kVectors; ++v) store(out + r * kPitch + v * LANES, vf{} + (bias ? bias[r] : 0.0f));
}

// out[r] += sum over c of m[r, c] in[c].
inline void add_product(const Matrix &m, const float *in, float *out) {
  constexpr int kRows = LANES == 16 ? 6 : 4, kColumns = LANES == 16 ? 4 : 2;  // sums in registers
  for (int r = 0; r < m.rows; r += kRows) {
    const int rows = m.rows - r < kRows ? m.rows - r : kRows;
    const float *weights[kRows];
    for (int i = 0; i < kRows; ++i) weights[i] = m.at + (r + (i < rows ? i : rows - 1)) * m.row_step;
    for (int v = 0; v < kVectors; v += kColumns) {
      vf sum[kRows][kColumns] = {};
      const float *from = in + v * LANES;
      for (int c = 0; c < m.columns; ++c, from += kPitch) {
        vf x[kColumns];
        for (int j = 0; j < kColumns; ++j) x[j] = load(from + j * LANES);
        for (int i = 0; i < kRows; ++i)
          for (int j = 0; j < kColumns; ++j) sum[i][j] += x[j] * weights[i][c * m.column_step];
      }
      for (int i = 0; i < rows; ++i)
        for (int j = 0; j < kColumns; ++j) {
          float *to = out + (r + i) * kPitch + (v + j) * LANES;
          store(to, load(to) + sum[i][j]);
        }
    }
  }
}

// sums[r * row_step + c] += sum over seeds of up[r] in[c].
inline void add_outer_product(const float *up, int rows, const float *in, int columns, int row_step, float *sums) {
  constexpr int kRows = LANES == 16 ? 4 : 2, kColumns = 4;
  for (int r = 0; r < rows; r += kRows)
    for (int c = 0; c < columns; c += kColumns) {
      vf sum[kRows * kColumns] = {};
      const float *down[kRows], *across[kColumns];
      for (int i = 0; i < kRows; ++i) down[i] = up + (r + i < rows ? r + i : rows - 1) * kPitch;
      for (int j = 0; j < kColumns; ++j) across[j] = in + (c + j < columns ? c + j : columns - 1) * kPitch;
      for (int v = 0; v < kVectors; ++v)
        for (int i = 0; i < kRows; ++i)
          for (int j = 0; j < kColumns; ++j)
            sum[i * kColumns + j] += load(down[i] + v * LANES) * load(across[j] + v * LANES);
      float totals[kRows * kColumns] = {};
      add_sums<kRows * kColumns>(sum, totals);
      for (int i = 0; i < kRows && r + i < rows; ++i)
        for (int j = 0; j < kColumns && c + j < columns; ++j)
          sums[(r + i) * row_step + c + j] += totals[i * kColumns + j];
    }
}

// sums[r] += sum over seeds of up[r].
inline void add_row_sums(const float *up, int rows, float *sums) {
  for (int r = 0; r < rows; ++r) {
    vf sum{};
    for (int v = 0; v < kVectors; ++v) sum += load(up + r * kPitch + v * LANES);
    add_sums<1>(&sum, sums + r);
  }
}

// Weights of a perceptron of one hidden layer, or the sums of their gradients: W2 max(W1 x + b1, 0) + b2.
template <class T>
struct PerceptronArrays {
  T *w1, *b1, *w2, *b2;
};

// W1 [hidden, inputs] has rows `w1_step` apart.
struct Perceptron : PerceptronArrays<const float> {
  int w1_step, inputs, hidden, outputs;

  Matrix first() const { return {w1, hidden, inputs, w1_step, 1}; }
  Matrix second() const { return {w2, outputs, hidden, hidden, 1}; }
};

inline void evaluate(const Perceptron &p, const float *in, float *hidden, float *out) {
  fill(p.b1, p.hidden, hidden);
  add_product(p.first(), in, hidden);
  for (int h = 0; h < p.hidden; ++h)
    for (int v = 0; v < kVectors; ++v) {
      float *at = hidden + h * kPitch + v * LANES;
      store(at, maxv(load(at), vf{}));
    }
  fill(p.b2, p.outputs, out);
  add_product(p.second(), hidden, out);
}

// From the gradients `up` of its outputs: adds those of its weights to `sums` and those of its inputs to `down`.
// `slopes`: memory for those of the hidden values.
inline void descend(const Perceptron &p, const float *in, const float *hidden, const float *up, float *slopes,
                    const PerceptronArrays<float> &sums, float *down) {
  add_row_sums(up, p.outputs, sums.b2);
  add_outer_product(up, p.outputs, hidden, p.hidden, p.hidden, sums.w2);
  fill(nullptr, p.hidden, slopes);
  add_product(p.second().turned(), up, slopes);
  for (int h = 0; h < p.hidden; ++h)
    for (int v = 0; v < kVectors; ++v) {
      float *at = slopes + h * kPitch + v * LANES;
      store(at, select(load(hidden + h * kPitch + v * LANES) > 0.0f, load(at), vf{}));
    }
  add_row_sums(slopes, p.hidden, sums.b1);
  add_outer_product(slopes, p.hidden, in, p.inputs, p.w1_step, sums.w1);
  add_product(p.first().turned(), slopes, down);
}

}  // namespace
}  // namespace sgi
