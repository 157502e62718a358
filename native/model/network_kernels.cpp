// MLP_p over vectors of LANES pairs of 16-bit integers.
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
}  // namespace

const NetworkKernel NetworkKernel::SGI_ISA{narrow::evaluate};

}  // namespace sgi
