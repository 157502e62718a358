#include "model/network.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "base/error.hpp"

namespace sgi {
namespace {

int padded(int count) { return (count + kNetworkPadding - 1) / kNetworkPadding * kNetworkPadding; }

// Whether all weights have 16 bits and all sums of values up to `limit`, biases included, 32.
bool fits(const std::vector<int64_t> &weights, const std::vector<int64_t> &bias, int inputs, int64_t limit) {
  for (size_t u = 0; u < bias.size(); ++u) {
    int64_t sum = 0;
    for (int i = 0; i < inputs; ++i) {
      const int64_t weight = std::abs(weights[u * size_t(inputs) + size_t(i)]);
      if (weight > INT16_MAX) return false;
      sum += weight;
    }
    if (std::abs(bias[u]) > INT32_MAX >> kInputBits) return false;
    if (sum * limit + (std::abs(bias[u]) << kInputBits) > INT32_MAX) return false;
  }
  return true;
}

// units x inputs, row by row, as pairs of inputs x `width` with zeros behind the units: two inputs in each number.
std::vector<int32_t> paired(const std::vector<int64_t> &from, int units, int inputs, int width) {
  std::vector<int32_t> to(size_t(inputs + 1) / 2 * width);
  for (int u = 0; u < units; ++u)
    for (int i = 0; i < inputs; ++i) {
      const auto half = uint32_t(uint16_t(from[size_t(u) * inputs + i])) << (i % 2 * 16);
      to[size_t(i / 2) * width + u] |= int32_t(half);
    }
  return to;
}

std::vector<int32_t> biases(const std::vector<int64_t> &from, int width) {
  std::vector<int32_t> to(width);
  for (size_t u = 0; u < from.size(); ++u) to[u] = int32_t(from[u] * (1 << kInputBits));
  return to;
}

// The largest sum of absolute values of a row.
int64_t largest_row(const std::vector<int64_t> &weights, int rows, int columns) {
  int64_t found = 0;
  for (int row = 0; row < rows; ++row) {
    int64_t sum = 0;
    for (int column = 0; column < columns; ++column) sum += std::abs(weights[size_t(row) * size_t(columns) + column]);
    found = std::max(found, sum);
  }
  return found;
}

// A unit's sum in integers of 64 bits.
template <class T>
int64_t sum_of(const std::vector<T> &values, const std::vector<int64_t> &weights, const std::vector<int64_t> &bias,
               size_t unit) {
  return std::inner_product(values.begin(), values.end(), weights.data() + unit * values.size(),
                            bias[unit] * (1 << kInputBits));
}

void evaluate_wide(const IntNetwork &net, const int16_t *row, int64_t *out) {
  std::vector<int> x(row, row + net.inputs);
  for (int &value : x) value = as_input(value);
  std::vector<int64_t> hidden(net.b1.size());
  for (size_t h = 0; h < hidden.size(); ++h)
    hidden[h] = std::clamp<int64_t>(sum_of(x, net.w1, net.b1, h) >> net.shift, 0, kHiddenLimit);
  for (size_t o = 0; o < net.b2.size(); ++o)
    out[o] = as_output(sum_of(hidden, net.w2, net.b2, o), int(o) < net.predicted, net.shift);
}

}  // namespace

void IntNetwork::require_exact() const {
  constexpr double kExact = double(int64_t(1) << 53);
  const int64_t first = largest_row(w1, hidden, inputs) * kInputLimit + (largest_row(b1, hidden, 1) << kInputBits);
  const int64_t second = largest_row(w2, outputs, hidden) * kHiddenLimit + (largest_row(b2, outputs, 1) << kInputBits);
  if (std::max(double(first), double(second) * kPerOctave) >= kExact || shift < 2 || shift > 20)
    throw Error(Fault::corrupt, "context model: weights too large to be evaluated exactly");
}

Network::Network(const IntNetwork &w, Isa isa) : kernel_(kernel_for<NetworkKernel>(isa)), outputs_(w.outputs) {
  if (!fits(w.w1, w.b1, w.inputs, kInputLimit) || !fits(w.w2, w.b2, w.hidden, kHiddenLimit)) {
    wide_ = w;
    return;
  }
  const int wide_hidden = padded(w.hidden), wide_outputs = padded(w.outputs);
  w1_ = paired(w.w1, w.hidden, w.inputs, wide_hidden);
  w2_ = paired(w.w2, w.outputs, w.hidden, wide_outputs);
  w2_.resize(size_t(wide_hidden) / 2 * wide_outputs);
  b1_ = biases(w.b1, wide_hidden);
  b2_ = biases(w.b2, wide_outputs);
  for (int o = 0; o < w.outputs; ++o)
    for (int h = 0; h < w.hidden; ++h) b2_[o] += int32_t(w.w2[size_t(o) * w.hidden + h] * kHiddenMiddle);
  narrow_ = {w1_.data(), b1_.data(),  w2_.data(), b2_.data(),  w.inputs,
             w.outputs,  w.predicted, w.shift,    wide_hidden, wide_outputs};
}

int64_t Network::scratch_size() const {
  return wide_ ? 0 : kNetworkRows * int64_t(narrow_.inputs + 1 + narrow_.wide_hidden + narrow_.wide_outputs) / 2;
}

void Network::evaluate(const int16_t *rows, int64_t stride, int64_t n, double *scratch, int64_t *out) const {
  if (!wide_) return kernel_.evaluate(narrow_, rows, stride, n, scratch, out);
  for (int64_t i = 0; i < n; ++i) evaluate_wide(*wide_, rows + i * stride, out + i * outputs_);
}

}  // namespace sgi
