// What the evaluation of MLP_p needs of an instruction set.
//
// Narrow networks have weights of 16 bits and sums of 32, as all have that were trained. Wide ones, whatever else a
// stream may hold, are evaluated in plain integers of 64 bits.
#pragma once
#include <cstdint>

#include "base/isa.hpp"
#include "model/constants.hpp"

namespace sgi {

constexpr int kNetworkRows = 8;      // at most, evaluated side by side, so that a weight is loaded once for all
constexpr int kNetworkPadding = 32;  // hidden units and outputs are padded with zeros to a multiple of it

// The weights transposed so that units lie side by side, two consecutive inputs of each in one 32-bit number, the first
// one in its lower half; biases times 64. Hidden values are kept less kHiddenMiddle, so that they have 16 bits; b2
// makes up for it.
struct NarrowNetwork {
  const int32_t *w1;  // [ceil(inputs / 2), wide_hidden]
  const int32_t *b1;  // [wide_hidden]
  const int32_t *w2;  // [wide_hidden / 2, wide_outputs]
  const int32_t *b2;  // [wide_outputs]
  int inputs, outputs, predicted, shift;
  int wide_hidden, wide_outputs;
};

constexpr int kHiddenMiddle = 1 << 14;

namespace {

inline int as_input(int value) {
  return value < -kInputLimit ? -kInputLimit : value > kInputLimit ? kInputLimit : value;
}

// A sum as what it means: a mean, or a scale or refinement.
inline int64_t as_output(int64_t sum, bool mean, int shift) {
  const int fraction = kInputBits + shift;
  return mean ? sum >> (fraction - kMeanBits) : (sum * kPerOctave) >> fraction;
}

}  // namespace

// `scratch` has room for kNetworkRows * (inputs + 1 + wide_hidden + wide_outputs) numbers of 4 bytes.
struct NetworkKernel {
  void (*evaluate)(const NarrowNetwork &net, const int16_t *rows, int64_t stride, int64_t n, double *scratch,
                   int64_t *out);
  static const NetworkKernel portable, avx2, avx512;
};

}  // namespace sgi
