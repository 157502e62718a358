#include "network.hpp"

#include <algorithm>
#include <vector>

#include "../../raster/cpp/kernel.hpp"
#include "../../raster/cpp/thread_pool.hpp"
#include "network_kernel.hpp"

namespace sgi {
namespace {

int padded(int count) { return (count + kNetworkPadding - 1) / kNetworkPadding * kNetworkPadding; }

NetworkKernel kernel_for(const std::string &isa) {
#ifdef SGI_X86
  const std::string name = choose_kernel(isa).name;
  if (name == "avx512") return network_avx512;
  if (name == "avx2") return network_avx2;
#else
  choose_kernel(isa);
#endif
  return network_portable;
}

// rows x columns, row by row, as columns x `wide` with zeros behind the rows.
std::vector<double> transposed(const int64_t *from, int rows, int columns, int wide) {
  std::vector<double> to(size_t(columns) * wide);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) to[size_t(c) * wide + r] = double(from[size_t(r) * columns + c]);
  return to;
}

std::vector<double> biases(const int64_t *from, int count, int wide) {
  std::vector<double> to(wide);
  for (int i = 0; i < count; ++i) to[i] = double(from[i] * (int64_t(1) << kInputBits));
  return to;
}

}  // namespace

void evaluate_network(const NetworkWeights &w, const int16_t *rows, int64_t stride, int64_t n, int threads,
                      const std::string &isa, int64_t *out) {
  const int wide_hidden = padded(w.hidden), wide_outputs = padded(w.outputs);
  const std::vector<double> w1 = transposed(w.w1, w.hidden, w.inputs, wide_hidden);
  const std::vector<double> b1 = biases(w.b1, w.hidden, wide_hidden);
  std::vector<double> w2 = transposed(w.w2, w.outputs, w.hidden, wide_outputs);
  w2.resize(size_t(wide_hidden) * wide_outputs);
  const std::vector<double> b2 = biases(w.b2, w.outputs, wide_outputs);
  const PackedNetwork net{w1.data(), b1.data(),   w2.data(), b2.data(),   w.inputs,
                          w.outputs, w.predicted, w.shift,   wide_hidden, wide_outputs};
  const NetworkKernel kernel = kernel_for(isa);
  constexpr int64_t kChunk = 512;
  parallel_for((n + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    const int64_t begin = chunk * kChunk, count = std::min(n - begin, kChunk);
    std::vector<double> scratch(net.scratch());
    kernel(net, rows + begin * stride, stride, count, scratch.data(), out + begin * net.outputs);
  });
}

}  // namespace sgi
