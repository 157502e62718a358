// Restoration over vectors of LANES pixels.
#ifdef SGI_X86
#include <immintrin.h>
#endif
#include "model/hidden_values.hpp"
#include "model/restoration_kernel.hpp"
#include "model/restoration_squares.hpp"

namespace sgi {
namespace {

using narrow::clipped;
using narrow::vi;

constexpr int kVectors = LANES == 16 ? 4 : 2;  // with a block of outputs the registers that there are
constexpr int kColumns = kVectors * LANES;
static_assert(kRestorationColumns % kColumns == 0, "a strip must hold whole vectors");
static_assert(kRestorationStride >= kRestorationColumns + 2, "rows must hold what is beside a strip");

template <int OUTPUTS>
using Sums = vi[OUTPUTS][kVectors];

// Of outputs of a block at kColumns pixels. in: the pixel above and to the left of the first one; `plane` from one pair
// of inputs to the next.
template <bool FUSED, int OUTPUTS>
inline void convolve(const LayerView &layer, const int32_t *weight, const int32_t *bias, const int32_t *in,
                     int64_t plane, Sums<OUTPUTS> &sum) {
  for (int o = 0; o < OUTPUTS; ++o)
    for (int v = 0; v < kVectors; ++v) sum[o][v] = vi{} + bias[o];
  for (int pair = 0; pair < layer.pairs; ++pair, in += plane)
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x, weight += kRestorationBlock) {
        vi value[kVectors];
        for (int v = 0; v < kVectors; ++v) {
          value[v] = narrow::load(in + y * kRestorationStride + x + v * LANES);
          keep(value[v]);
        }
        for (int o = 0; o < OUTPUTS; ++o)
          for (int v = 0; v < kVectors; ++v) {
            sum[o][v] = narrow::add_products<FUSED>(sum[o][v], value[v], vi{} + weight[o]);
            keep(sum[o][v]);
          }
      }
}

template <bool FUSED, bool LAST>
bool layer_as(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, int32_t *out) {
  const int64_t plane_in = (rows + 2) * kRestorationStride, plane = rows * kRestorationStride;
  constexpr int kOutputs = LAST ? kRestorationLast : kRestorationBlock;
  vi bits{};
  for (int64_t row = 0; row < rows; ++row)
    for (int block = 0; block < layer.blocks; ++block) {
      const int32_t *weights = layer.weights + int64_t(block) * layer.pairs * kRestorationTaps * kRestorationBlock;
      for (int64_t x = 0; x < columns; x += kColumns) {
        const int64_t at = row * kRestorationStride + x;
        Sums<kOutputs> sum;
        convolve<FUSED, kOutputs>(layer, weights, layer.biases + block * kRestorationBlock, in + at, plane_in, sum);
        for (int v = 0; v < kVectors; ++v)
          if constexpr (LAST) {
            for (int o = 0; o < kOutputs; ++o)
              narrow::store(out + (block * kRestorationBlock + o) * plane + at + v * LANES, sum[o][v]);
          } else {
            for (int o = 0; o < kOutputs; o += 2) {
              const vi pairs = pair_of(activation(sum[o][v], layer.shift), activation(sum[o + 1][v], layer.shift));
              bits |= pairs;
              narrow::store(out + (block * kRestorationBlock + o) / 2 * plane + at + v * LANES, pairs);
            }
          }
      }
    }
  return is_small(bits);
}

// Scalar WebAssembly, for browsers of before 2021, must stay small.
#if defined(__wasm__) && !defined(__wasm_simd128__)
constexpr bool kHasSquares = false;
#else
constexpr bool kHasSquares = true;
#endif

template <bool FUSED>
bool hidden_as(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, bool small, int32_t *out) {
  if constexpr (kHasSquares) {
    if (small && layer.squares) return squares::layer_as<FUSED>(layer, in, rows, columns, out);
  }
  return layer_as<FUSED, false>(layer, in, rows, columns, out);
}

bool hidden_layer(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, bool small, int32_t *out) {
  return narrow::has_fused() ? hidden_as<true>(layer, in, rows, columns, small, out)
                             : hidden_as<false>(layer, in, rows, columns, small, out);
}

void last_layer(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, int32_t *out) {
  narrow::has_fused() ? layer_as<true, true>(layer, in, rows, columns, out)
                      : layer_as<false, true>(layer, in, rows, columns, out);
}

// The nearest integer, ties to even, within the limits; 0 for not-a-number.
inline int32_t input_of(float value) {
  constexpr float kMax = float(kRestorationMost), kMagic = 12582912.0f;  // 1.5 * 2^23: adding it leaves no fraction
  value = value == value ? value : 0.0f;
  value = value > -kMax ? value : -kMax;
  value = value < kMax ? value : kMax;
  return int32_t((value + kMagic) - kMagic);
}

void to_inputs(const float *row, int64_t plane, int channels, int64_t pixels, float scale, int32_t *first,
               int32_t *second) {
  if (channels == 1) {
    for (int64_t i = 0; i < pixels; ++i) first[i] = input_of(row[i] * scale) & 0xffff, second[i] = 0;
    return;
  }
  const float *next = row + plane, *last = next + plane;
  for (int64_t i = 0; i < pixels; ++i) {
    const int32_t a = input_of(row[i] * scale), b = input_of(next[i] * scale), c = input_of(last[i] * scale);
    first[i] = int32_t(uint32_t(a & 0xffff) | uint32_t(b) << 16), second[i] = c & 0xffff;
  }
}

void add_correction(const int32_t *sums, int64_t pixels, float scale, const float *values, float *restored) {
  for (int64_t i = 0; i < pixels; ++i) restored[i] = values[i] + float(sums[i]) * scale;
}

}  // namespace

const RestorationKernel RestorationKernel::SGI_ISA{to_inputs, hidden_layer, last_layer, add_correction};

}  // namespace sgi
