// The evaluation of MLP_p, written once over vectors of LANES doubles (compiler vector extensions) and included by one
// translation unit per instruction set. Only what is inline may be included here.
#include <cstring>

#include "network_kernel.hpp"

namespace sgi {
namespace {

using vd = double __attribute__((vector_size(LANES * 8)));

constexpr int kRows = kNetworkRows;
constexpr int kBlock = 2;  // vectors of units side by side; with kRows the chains that hide the latency of a sum
static_assert(kNetworkPadding % (kBlock * LANES) == 0, "padding must hold whole blocks");

using Sums = vd[kRows][kBlock];

inline vd load(const double *p) {
  vd v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

// sum[r] = bias + sum over i of x[i][r] * w[i], for one block of units.
inline void layer(const double *x, int count, const double *w, int width, const double *bias, Sums &sum) {
  for (int r = 0; r < kRows; ++r)
    for (int b = 0; b < kBlock; ++b) sum[r][b] = load(bias + b * LANES);
  for (int i = 0; i < count; ++i) {
    vd weight[kBlock];
    for (int b = 0; b < kBlock; ++b) weight[b] = load(w + int64_t(i) * width + b * LANES);
    for (int r = 0; r < kRows; ++r)
      for (int b = 0; b < kBlock; ++b) sum[r][b] += x[i * kRows + r] * weight[b];
  }
}

// to[unit][r] = sum: what the next layer multiplies lies side by side.
inline void transpose(const Sums &sum, double *to) {
  for (int b = 0; b < kBlock; ++b)
    for (int lane = 0; lane < LANES; ++lane)
      for (int r = 0; r < kRows; ++r) to[(b * LANES + lane) * kRows + r] = sum[r][b][lane];
}

inline vd clipped(vd v, double low, double high) {
  const vd least = vd{} + low, most = vd{} + high;
  v = v < least ? least : v;
  return v > most ? most : v;
}

inline void read_inputs(const PackedNetwork &net, const int16_t *rows, int64_t stride, int count, double *x) {
  for (int r = 0; r < kRows; ++r) {
    const int16_t *row = rows + (r < count ? r : 0) * stride;
    for (int i = 0; i < net.inputs; ++i) {
      const int value = row[i];
      x[i * kRows + r] = value < -kInputLimit ? -kInputLimit : value > kInputLimit ? kInputLimit : value;
    }
  }
}

inline void write_outputs(const PackedNetwork &net, const double *y, int count, int64_t *out) {
  const int fraction = kInputBits + net.shift;
  for (int r = 0; r < count; ++r)
    for (int o = 0; o < net.outputs; ++o) {
      const int64_t value = int64_t(y[o * kRows + r]);
      out[int64_t(r) * net.outputs + o] =
          o < net.predicted ? value >> (fraction - kMeanBits) : (value * kPerOctave) >> fraction;
    }
}

void evaluate(const PackedNetwork &net, const int16_t *rows, int64_t stride, int64_t n, double *x, int64_t *out) {
  double *hidden = x + int64_t(net.inputs) * kRows, *y = hidden + int64_t(net.wide_hidden) * kRows;
  const double unit = 1.0 / double(int64_t(1) << net.shift);
  for (int64_t first = 0; first < n; first += kRows) {
    const int count = n - first < kRows ? int(n - first) : kRows;
    read_inputs(net, rows + first * stride, stride, count, x);
    for (int at = 0; at < net.wide_hidden; at += kBlock * LANES) {
      Sums sum;
      layer(x, net.inputs, net.w1 + at, net.wide_hidden, net.b1 + at, sum);
      for (auto &row : sum)
        for (vd &v : row) v = clipped(v * unit, 0.0, double(kHiddenLimit));
      transpose(sum, hidden + at * kRows);
    }
    for (int i = 0; i < net.wide_hidden * kRows; ++i) hidden[i] = double(int32_t(hidden[i]));  // rounds down: none is < 0
    for (int at = 0; at < net.wide_outputs; at += kBlock * LANES) {
      Sums sum;
      layer(hidden, net.wide_hidden, net.w2 + at, net.wide_outputs, net.b2 + at, sum);
      transpose(sum, y + at * kRows);
    }
    write_outputs(net, y, count, out + first * net.outputs);
  }
}

}  // namespace
}  // namespace sgi
