// What the evaluation of MLP_p needs; one implementation per instruction set.
#pragma once
#include "network.hpp"

namespace sgi {

constexpr int kNetworkRows = 4;      // evaluated side by side, so that a weight is loaded once for all
constexpr int kNetworkPadding = 16;  // hidden units and outputs are padded with zeros to a multiple of it

// The weights as float64, transposed so that units lie side by side, biases times 64.
struct PackedNetwork {
  const double *w1;  // [inputs, wide_hidden]
  const double *b1;  // [wide_hidden]
  const double *w2;  // [wide_hidden, wide_outputs]
  const double *b2;  // [wide_outputs]
  int inputs, outputs, predicted, shift;
  int wide_hidden, wide_outputs;

  int64_t scratch() const { return int64_t(kNetworkRows) * (inputs + wide_hidden + wide_outputs); }
};

// `scratch` has room for as many numbers as net.scratch() says.
using NetworkKernel = void (*)(const PackedNetwork &net, const int16_t *rows, int64_t stride, int64_t n,
                               double *scratch, int64_t *out);

void network_portable(const PackedNetwork &, const int16_t *, int64_t, int64_t, double *, int64_t *);
#ifdef SGI_X86
void network_avx2(const PackedNetwork &, const int16_t *, int64_t, int64_t, double *, int64_t *);
void network_avx512(const PackedNetwork &, const int16_t *, int64_t, int64_t, double *, int64_t *);
#endif

}  // namespace sgi
