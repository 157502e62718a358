// Products of matrices with what a batch of seeds has: rows of kPitch floats, of which the first kBatchSeeds count, a
// seed in each column.
#pragma once
#include <utility>

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

inline void clear(int rows, float *out) {
  for (int r = 0; r < rows; ++r)
    for (int v = 0; v < kVectors; ++v) store(out + r * kPitch + v * LANES, vf{});
}

// Calls take(r, at, sum over c of m[r, c] in[c]) for each row and each vector of seeds, which lies `at` floats from the
// start of a batch's rows, at row r.
template <class Take>
inline void multiply(const Matrix &m, const float *in, const Take &take) {
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
        for (int j = 0; j < kColumns; ++j) take(r + i, (r + i) * kPitch + (v + j) * LANES, sum[i][j]);
    }
  }
}

// Rows of LANES floats as columns.
template <size_t... I>
inline void turn(vf (&v)[LANES], std::index_sequence<I...>) {
  for (int span = 1; span < LANES; span *= 2) {
    vf next[LANES];
    for (int i = 0; i < LANES / 2; ++i) {
      const vf a = v[i], b = v[i + LANES / 2];
#if defined(__clang__)
      next[2 * i] = __builtin_shufflevector(a, b, int(I / 2 + I % 2 * LANES)...);
      next[2 * i + 1] = __builtin_shufflevector(a, b, int(I / 2 + I % 2 * LANES + LANES / 2)...);
#else
      next[2 * i] = __builtin_shuffle(a, b, vi{int32_t(I / 2 + I % 2 * LANES)...});
      next[2 * i + 1] = __builtin_shuffle(a, b, vi{int32_t(I / 2 + I % 2 * LANES + LANES / 2)...});
#endif
    }
    for (int i = 0; i < LANES; ++i) v[i] = next[i];
  }
}

// Floats of a seed where `columns` rows are turned.
constexpr int turned_step(int columns) { return (columns + LANES - 1) / LANES * LANES; }

// Rows seed by seed: out[seed * turned_step(columns) + column].
inline void turn_rows(const float *rows, int columns, float *out) {
  for (int c = 0; c < columns; c += LANES)
    for (int v = 0; v < kVectors; ++v) {
      vf block[LANES];
      for (int i = 0; i < LANES; ++i)
        block[i] = load(rows + (c + i < columns ? c + i : columns - 1) * kPitch + v * LANES);
      turn(block, std::make_index_sequence<LANES>{});
      for (int i = 0; i < LANES; ++i) store(out + (v * LANES + i) * turned_step(columns) + c, block[i]);
    }
}

// The next for ACROSS vectors of columns from `column` on.
template <int ACROSS>
inline void add_outer_columns(const float *up, int rows, const float *turned, int column, int columns, int row_step,
                              float *sums) {
  constexpr int kRows = LANES == 16 ? 6 : 4;
  for (int r = 0; r < rows; r += kRows) {
    const float *down[kRows], *across = turned + column;
    for (int i = 0; i < kRows; ++i) down[i] = up + (r + i < rows ? r + i : rows - 1) * kPitch;
    vf sum[kRows][ACROSS] = {};
    for (int seed = 0; seed < kBatchSeeds; ++seed, across += turned_step(columns))
      for (int j = 0; j < ACROSS; ++j) {
        const vf x = load(across + j * LANES);
        for (int i = 0; i < kRows; ++i) sum[i][j] += x * down[i][seed];
      }
    for (int i = 0; i < kRows && r + i < rows; ++i)
      for (int j = 0; j < ACROSS; ++j) {
        float *to = sums + (r + i) * row_step + column + j * LANES;
        if (column + (j + 1) * LANES <= columns)
          store(to, load(to) + sum[i][j]);
        else
          for (int l = 0; column + j * LANES + l < columns; ++l) to[l] += lane(sum[i][j], l);
      }
  }
}

// sums[r * row_step + c] += sum over seeds of up[r] in[c], of `in` as turn_rows leaves it.
inline void add_outer_product(const float *up, int rows, const float *turned, int columns, int row_step, float *sums) {
  for (int c = 0; c < columns; c += 2 * LANES) {
    if (c + LANES < columns)
      add_outer_columns<2>(up, rows, turned, c, columns, row_step, sums);
    else
      add_outer_columns<1>(up, rows, turned, c, columns, row_step, sums);
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
  multiply(p.first(), in, [&](int r, int at, vf sum) { store(hidden + at, maxv(sum + p.b1[r], vf{})); });
  multiply(p.second(), hidden, [&](int r, int at, vf sum) { store(out + at, sum + p.b2[r]); });
}

// From the gradients `up` of its outputs: adds those of its weights to `sums` and those of its inputs to `down`.
// `slopes`: memory for those of the hidden values; `turned`: for what either layer sees.
inline void descend(const Perceptron &p, const float *in, const float *hidden, const float *up, float *slopes,
                    float *turned, const PerceptronArrays<float> &sums, float *down) {
  add_row_sums(up, p.outputs, sums.b2);
  turn_rows(hidden, p.hidden, turned);
  add_outer_product(up, p.outputs, turned, p.hidden, p.hidden, sums.w2);
  multiply(p.second().turned(), up,
           [&](int, int at, vf sum) { store(slopes + at, select(load(hidden + at) > 0.0f, sum, vf{})); });
  add_row_sums(slopes, p.hidden, sums.b1);
  turn_rows(in, p.inputs, turned);
  add_outer_product(slopes, p.hidden, turned, p.inputs, p.w1_step, sums.w1);
  multiply(p.first().turned(), slopes, [&](int, int at, vf sum) { store(down + at, load(down + at) + sum); });
}

}  // namespace
}  // namespace sgi
