#include "model/network.hpp"

#include <algorithm>
#include <cstdlib>
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

// units x inputs, row by row, as inputs x `width` with zeros behind the units.
std::vector<double> transposed(const int64_t *from, int units, int inputs, int width) {
  std::vector<double> to(size_t(inputs) * width);
  for (int u = 0; u < units; ++u)
    for (int i = 0; i < inputs; ++i) to[size_t(i) * width + u] = double(from[size_t(u) * inputs + i]);
  return to;
}

// The same with two inputs in each number.
std::vector<int32_t> paired(const int64_t *from, int units, int inputs, int width) {
  std::vector<int32_t> to(size_t(inputs + 1) / 2 * width);
  for (int u = 0; u < units; ++u)
    for (int i = 0; i < inputs; ++i) {
      const auto half = uint32_t(uint16_t(from[size_t(u) * inputs + i])) << (i % 2 * 16);
      to[size_t(i / 2) * width + u] |= int32_t(half);
    }
  return to;
}

template <class T>
std::vector<T> biases(const int64_t *from, int units, int width) {
  std::vector<T> to(width);
  for (int u = 0; u < units; ++u) to[u] = T(from[u] * (int64_t(1) << kInputBits));
  return to;
}

}  // namespace

struct Network::Packed {
  const NetworkKernel &kernel;
  bool is_narrow;
  std::vector<int32_t> narrow_w1, narrow_b1, narrow_w2, narrow_b2;
  std::vector<double> wide_w1, wide_b1, wide_w2, wide_b2;
  NarrowNetwork narrow;
  WideNetwork wide;

  void pack_narrow(const NetworkWeights &w, int wide_hidden, int wide_outputs) {
    narrow_w1 = paired(w.w1, w.hidden, w.inputs, wide_hidden);
    narrow_w2 = paired(w.w2, w.outputs, w.hidden, wide_outputs);
    narrow_w2.resize(size_t(wide_hidden) / 2 * wide_outputs);
    narrow_b1 = biases<int32_t>(w.b1, w.hidden, wide_hidden);
    narrow_b2 = biases<int32_t>(w.b2, w.outputs, wide_outputs);
    for (int o = 0; o < w.outputs; ++o)
      for (int h = 0; h < w.hidden; ++h) narrow_b2[o] += int32_t(w.w2[size_t(o) * w.hidden + h] * kHiddenMiddle);
    narrow = {narrow_w1.data(), narrow_b1.data(), narrow_w2.data(), narrow_b2.data(), w.inputs,
              w.outputs,        w.predicted,      w.shift,          wide_hidden,      wide_outputs};
  }

  void pack_wide(const NetworkWeights &w, int wide_hidden, int wide_outputs) {
    wide_w1 = transposed(w.w1, w.hidden, w.inputs, wide_hidden);
    wide_w2 = transposed(w.w2, w.outputs, w.hidden, wide_outputs);
    wide_w2.resize(size_t(wide_hidden) * wide_outputs);
    wide_b1 = biases<double>(w.b1, w.hidden, wide_hidden);
    wide_b2 = biases<double>(w.b2, w.outputs, wide_outputs);
    wide = {wide_w1.data(), wide_b1.data(), wide_w2.data(), wide_b2.data(), w.inputs,
            w.outputs,      w.predicted,    w.shift,        wide_hidden,    wide_outputs};
  }
};

Network::Network(const NetworkWeights &w, Isa isa)
    : packed_(new Packed{kernel_for<NetworkKernel>(isa), false, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}}) {
  const int wide_hidden = padded(w.hidden), wide_outputs = padded(w.outputs);
  packed_->is_narrow =
      fits(w.w1, w.b1, w.hidden, w.inputs, kInputLimit) && fits(w.w2, w.b2, w.outputs, w.hidden, kHiddenLimit);
  if (packed_->is_narrow)
    packed_->pack_narrow(w, wide_hidden, wide_outputs);
  else
    packed_->pack_wide(w, wide_hidden, wide_outputs);
}

Network::~Network() = default;

int Network::outputs() const { return packed_->is_narrow ? packed_->narrow.outputs : packed_->wide.outputs; }

int64_t Network::scratch_size() const {
  const auto size = [](const auto &net) {
    return kNetworkRows * int64_t(net.inputs + 1 + net.wide_hidden + net.wide_outputs);
  };
  return packed_->is_narrow ? size(packed_->narrow) : size(packed_->wide);
}

void Network::evaluate(const int16_t *rows, int64_t stride, int64_t n, double *scratch, int64_t *out) const {
  if (packed_->is_narrow)
    packed_->kernel.narrow(packed_->narrow, rows, stride, n, scratch, out);
  else
    packed_->kernel.wide(packed_->wide, rows, stride, n, scratch, out);
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
