// MLP_p, narrow over vectors of LANES pairs of 16-bit integers, wide over vectors of LANES / 2 doubles.
#ifdef SGI_X86
#include <immintrin.h>
#endif

#include "model/network_kernel.hpp"
#include "model/pair_products.hpp"

namespace sgi {
namespace {
namespace narrow {

using vs = int16_t __attribute__((vector_size(LANES * 2)));

constexpr int kRows = LANES == 16 ? kNetworkRows : kNetworkRows / 2;  // a block fills the registers
static_assert(kNetworkPadding % (2 * LANES) == 0, "padding must hold whole blocks");

// sum[r] = bias + sum over pairs of inputs of row r, `stride` apart, for BLOCK vectors of units.
template <bool FUSED, int BLOCK>
inline void layer(const int32_t *x, int stride, int pairs, const int32_t *w, int width, const int32_t *bias,
                  vi (&sum)[kRows][BLOCK]) {
  for (int r = 0; r < kRows; ++r)
    for (int b = 0; b < BLOCK; ++b) sum[r][b] = load(bias + b * LANES);
  for (int i = 0; i < pairs; ++i) {
    vi weight[BLOCK];
    for (int b = 0; b < BLOCK; ++b) weight[b] = load(w + int64_t(i) * width + b * LANES);
    for (int r = 0; r < kRows; ++r)
      for (int b = 0; b < BLOCK; ++b) sum[r][b] = add_products<FUSED>(sum[r][b], vi{} + x[r * stride + i], weight[b]);
  }
}

inline void read_inputs(const NarrowNetwork &net, const int16_t *rows, int64_t stride, int count, int pairs,
                        int32_t *x) {
  for (int r = 0; r < kRows; ++r) {
    const int16_t *row = rows + (r < count ? r : 0) * stride;
    int16_t *to = reinterpret_cast<int16_t *>(x + r * pairs);
    for (int i = 0; i < net.inputs; ++i) to[i] = int16_t(as_input(row[i]));
    if (net.inputs % 2) to[net.inputs] = 0;
  }
}

template <bool FUSED>
void evaluate_as(const NarrowNetwork &net, const int16_t *rows, int64_t stride, int64_t n, double *scratch,
                 int64_t *out) {
  const int pairs = (net.inputs + 1) / 2, hidden_pairs = net.wide_hidden / 2;
  int32_t *x = reinterpret_cast<int32_t *>(scratch), *hidden = x + kRows * pairs, *y = hidden + kRows * hidden_pairs;
  for (int64_t first = 0; first < n; first += kRows) {
    const int count = n - first < kRows ? int(n - first) : kRows;
    read_inputs(net, rows + first * stride, stride, count, pairs, x);
    for (int at = 0; at < net.wide_hidden; at += 2 * LANES) {
      vi sum[kRows][2];
      layer<FUSED>(x, pairs, pairs, net.w1 + at, net.wide_hidden, net.b1 + at, sum);
      for (int r = 0; r < kRows; ++r)
        for (int b = 0; b < 2; ++b) {
          const vs kept = __builtin_convertvector(clipped(sum[r][b] >> net.shift, 0, kHiddenLimit) - kHiddenMiddle, vs);
          __builtin_memcpy(reinterpret_cast<int16_t *>(hidden + r * hidden_pairs) + at + b * LANES, &kept, sizeof kept);
        }
    }
    for (int at = 0; at < net.outputs; at += LANES) {
      vi sum[kRows][1];
      layer<FUSED>(hidden, hidden_pairs, hidden_pairs, net.w2 + at, net.wide_outputs, net.b2 + at, sum);
      for (int r = 0; r < kRows; ++r) __builtin_memcpy(y + r * net.wide_outputs + at, &sum[r][0], sizeof sum[r][0]);
    }
    for (int r = 0; r < count; ++r) {
      const int32_t *from = y + r * net.wide_outputs;
      int64_t *to = out + (first + r) * net.outputs;
      for (int o = 0; o < net.predicted; ++o) to[o] = as_output(from[o], true, net.shift);
      for (int o = net.predicted; o < net.outputs; ++o) to[o] = as_output(from[o], false, net.shift);
    }
  }
}

void evaluate(const NarrowNetwork &net, const int16_t *rows, int64_t stride, int64_t n, double *scratch, int64_t *out) {
  has_fused() ? evaluate_as<true>(net, rows, stride, n, scratch, out)
              : evaluate_as<false>(net, rows, stride, n, scratch, out);
}

}  // namespace narrow
namespace wide {

constexpr int kLanes = LANES / 2;
using vd = double __attribute__((vector_size(kLanes * 8)));

constexpr int kRows = 4;
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
      for (int i = 0; i < net.inputs; ++i)
        x[i * kRows + r] = as_input(rows[(first + (r < count ? r : 0)) * stride + i]);
    for (int at = 0; at < net.wide_hidden; at += kBlock * kLanes) {
      Sums sum;
      layer(x, net.inputs, net.w1 + at, net.wide_hidden, net.b1 + at, sum);
      for (auto &row : sum)
        for (vd &v : row) v = clipped(v * unit, 0.0, double(kHiddenLimit));
      transpose(sum, hidden + at * kRows);
    }
    for (int i = 0; i < net.wide_hidden * kRows; ++i)
      hidden[i] = double(int32_t(hidden[i]));  // rounds down: none is < 0
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

const NetworkKernel NetworkKernel::SGI_ISA{narrow::evaluate, wide::evaluate};

}  // namespace sgi
