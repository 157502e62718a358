// MLP_p over vectors of LANES / 2 doubles (compiler vector extensions), for the translation unit of one instruction set.
// Only what is inline may be included here.
#include "network_kernel.hpp"

namespace sgi {
namespace {
namespace wide {

constexpr int kLanes = LANES / 2;
using vd = double __attribute__((vector_size(kLanes * 8)));

constexpr int kRows = kNetworkRows;
constexpr int kBlock = 2;  // vectors of units side by side; with kRows the chains that hide the latency of a sum
static_assert(kNetworkPadding % (kBlock * kLanes) == 0, "padding must hold whole blocks");

using Sums = vd[kRows][kBlock];

inline vd load(const double *p) {
  vd v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

// sum[r] = bias + sum over i of x[i][r] * w[i], for one block of units.
inline void layer(const double *x, int count, const double *w, int width, const double *bias, Sums &sum) {
  for (int r = 0; r < kRows; ++r)
    for (int b = 0; b < kBlock; ++b) sum[r][b] = load(bias + b * kLanes);
  for (int i = 0; i < count; ++i) {
    vd weight[kBlock];
    for (int b = 0; b < kBlock; ++b) weight[b] = load(w + int64_t(i) * width + b * kLanes);
    for (int r = 0; r < kRows; ++r)
      for (int b = 0; b < kBlock; ++b) sum[r][b] += x[i * kRows + r] * weight[b];
  }
}

// to[unit][r] = sum: what the next layer multiplies lies side by side.
inline void transpose(const Sums &sum, double *to) {
  for (int b = 0; b < kBlock; ++b)
    for (int lane = 0; lane < kLanes; ++lane)
      for (int r = 0; r < kRows; ++r) to[(b * kLanes + lane) * kRows + r] = sum[r][b][lane];
}

inline vd clipped(vd v, double low, double high) {
  const vd least = vd{} + low, most = vd{} + high;
  v = v < least ? least : v;
  return v > most ? most : v;
}

void evaluate(const WideNetwork &net, const int16_t *rows, int64_t stride, int64_t n, double *x, int64_t *out) {
  double *hidden = x + int64_t(net.inputs) * kRows, *y = hidden + int64_t(net.wide_hidden) * kRows;
  const double unit = 1.0 / double(int64_t(1) << net.shift);
  for (int64_t first = 0; first < n; first += kRows) {
    const int count = n - first < kRows ? int(n - first) : kRows;
    for (int r = 0; r < kRows; ++r)
      for (int i = 0; i < net.inputs; ++i) x[i * kRows + r] = as_input(rows[(first + (r < count ? r : 0)) * stride + i]);
    for (int at = 0; at < net.wide_hidden; at += kBlock * kLanes) {
      Sums sum;
      layer(x, net.inputs, net.w1 + at, net.wide_hidden, net.b1 + at, sum);
      for (auto &row : sum)
        for (vd &v : row) v = clipped(v * unit, 0.0, double(kHiddenLimit));
      transpose(sum, hidden + at * kRows);
    }
    for (int i = 0; i < net.wide_hidden * kRows; ++i) hidden[i] = double(int32_t(hidden[i]));  // rounds down: none is < 0
    for (int at = 0; at < net.wide_outputs; at += kBlock * kLanes) {
      Sums sum;
      layer(hidden, net.wide_hidden, net.w2 + at, net.wide_outputs, net.b2 + at, sum);
      transpose(sum, y + at * kRows);
    }
    for (int r = 0; r < count; ++r)
      for (int o = 0; o < net.outputs; ++o)
        out[(first + r) * net.outputs + o] = as_output(int64_t(y[o * kRows + r]), o < net.predicted, net.shift);
  }
}

}  // namespace wide
}  // namespace
}  // namespace sgi
