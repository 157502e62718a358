#include "model/network.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <vector>

#include "base/thread_pool.hpp"
#include "model/network_kernel.hpp"

namespace sgi {
namespace {

int padded(int count) { return (count + kNetworkPadding - 1) / kNetworkPadding * kNetworkPadding; }

// Whether all weights have 16 bits and all sums of values up to `limit`, biases included, 32.
bool fits(const int64_t *weights, const int64_t *bias, int units, int inputs, int64_t limit) {
  for (int u = 0; u < units; ++u) {
    int64_t sum = 0;
    for (int i = 0; i < inputs; ++i) {
      const int64_t weight = std::abs(weights[int64_t(u) * inputs + i]);
      if (weight > INT16_MAX) return false;
      sum += weight;
    }
    if (std::abs(bias[u]) > INT32_MAX >> kInputBits) return false;
    if (sum * limit + (std::abs(bias[u]) << kInputBits) > INT32_MAX) return false;
  }
  return true;
}

// units x inputs, row by row, as pairs of inputs x `width` with zeros behind the units: two inputs in each number.
std::vector<int32_t> paired(const int64_t *from, int units, int inputs, int width) {
  std::vector<int32_t> to(size_t(inputs + 1) / 2 * width);
  for (int u = 0; u < units; ++u)
    for (int i = 0; i < inputs; ++i) {
      const auto half = uint32_t(uint16_t(from[size_t(u) * inputs + i])) << (i % 2 * 16);
      to[size_t(i / 2) * width + u] |= int32_t(half);
    }
  return to;
}

std::vector<int32_t> biases(const int64_t *from, int units, int width) {
  std::vector<int32_t> to(width);
  for (int u = 0; u < units; ++u) to[u] = int32_t(from[u] * (1 << kInputBits));
  return to;
}

// A network in integers of 64 bits.
struct WideNetwork {
  std::vector<int64_t> w1, b1, w2, b2;  // as NetworkWeights have them
  int inputs, predicted, shift;

  explicit WideNetwork(const NetworkWeights &w)
      : w1(w.w1, w.w1 + int64_t(w.hidden) * w.inputs), b1(w.b1, w.b1 + w.hidden),
        w2(w.w2, w.w2 + int64_t(w.outputs) * w.hidden), b2(w.b2, w.b2 + w.outputs), inputs(w.inputs),
        predicted(w.predicted), shift(w.shift) {}

  template <class T>
  static int64_t sum(const T *values, size_t count, const std::vector<int64_t> &weights,
                     const std::vector<int64_t> &bias, size_t unit) {
    return std::inner_product(values, values + count, weights.data() + unit * count, bias[unit] * (1 << kInputBits));
  }

  void evaluate(const int16_t *row, int64_t *out) const {
    std::vector<int> x(row, row + inputs);
    for (int &value : x) value = as_input(value);
    std::vector<int64_t> hidden(b1.size());
    for (size_t h = 0; h < hidden.size(); ++h)
      hidden[h] = std::clamp<int64_t>(sum(x.data(), x.size(), w1, b1, h) >> shift, 0, kHiddenLimit);
    for (size_t o = 0; o < b2.size(); ++o)
      out[o] = as_output(sum(hidden.data(), hidden.size(), w2, b2, o), int(o) < predicted, shift);
  }
};

}  // namespace

struct Network::Packed {
  const NetworkKernel &kernel;
  int outputs;
  std::optional<WideNetwork> wide;  // where the narrow one does not hold it
  std::vector<int32_t> w1, b1, w2, b2;
  NarrowNetwork narrow;

  Packed(const NetworkWeights &w, Isa isa) : kernel(kernel_for<NetworkKernel>(isa)), outputs(w.outputs) {
    if (!fits(w.w1, w.b1, w.hidden, w.inputs, kInputLimit) || !fits(w.w2, w.b2, w.outputs, w.hidden, kHiddenLimit)) {
      wide.emplace(w);
      return;
    }
    const int wide_hidden = padded(w.hidden), wide_outputs = padded(w.outputs);
    w1 = paired(w.w1, w.hidden, w.inputs, wide_hidden);
    w2 = paired(w.w2, w.outputs, w.hidden, wide_outputs);
    w2.resize(size_t(wide_hidden) / 2 * wide_outputs);
    b1 = biases(w.b1, w.hidden, wide_hidden);
    b2 = biases(w.b2, w.outputs, wide_outputs);
    for (int o = 0; o < w.outputs; ++o)
      for (int h = 0; h < w.hidden; ++h) b2[o] += int32_t(w.w2[size_t(o) * w.hidden + h] * kHiddenMiddle);
    narrow = {w1.data(), b1.data(),   w2.data(), b2.data(),   w.inputs,
              w.outputs, w.predicted, w.shift,   wide_hidden, wide_outputs};
  }
};

Network::Network(const NetworkWeights &w, Isa isa) : packed_(new Packed(w, isa)) {}

Network::~Network() = default;

int Network::outputs() const { return packed_->outputs; }

int64_t Network::scratch_size() const {
  const NarrowNetwork &net = packed_->narrow;
  return packed_->wide ? 0 : kNetworkRows * int64_t(net.inputs + 1 + net.wide_hidden + net.wide_outputs) / 2;
}

void Network::evaluate(const int16_t *rows, int64_t stride, int64_t n, double *scratch, int64_t *out) const {
  if (!packed_->wide) return packed_->kernel.evaluate(packed_->narrow, rows, stride, n, scratch, out);
  for (int64_t i = 0; i < n; ++i) packed_->wide->evaluate(rows + i * stride, out + i * packed_->outputs);
}

void evaluate_network(const NetworkWeights &w, const int16_t *rows, int64_t stride, int64_t n, int threads, Isa isa,
                      int64_t *out) {
  const Network network(w, isa);
  constexpr int64_t kChunk = 512;
  parallel_for((n + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    const int64_t begin = chunk * kChunk, count = std::min(n - begin, kChunk);
    std::vector<double> scratch(network.scratch_size());
    network.evaluate(rows + begin * stride, stride, count, scratch.data(), out + begin * w.outputs);
  });
}

}  // namespace sgi
