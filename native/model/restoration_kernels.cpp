// Restoration over vectors of LANES pixels.
#ifdef SGI_X86
#include <immintrin.h>
#endif
#include <algorithm>
#include <array>

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

// How far apart pixels and channels are, where that is known when this is compiled: three channels of a pixel, or
// planes of pixels; 0 for what the mix says.
template <int PIXEL, int CHANNEL>
struct Apart {
  explicit Apart(const RestorationMix &mix)
      : pixel(PIXEL ? PIXEL : mix.pixel), channel(CHANNEL ? CHANNEL : mix.channel) {}
  const int64_t pixel, channel;
};

// Calls body(Apart) as it suits a mix of three channels.
template <class Body>
inline void as_apart(const RestorationMix &mix, Body body) {
  if (mix.pixel == 3 && mix.channel == 1) return body(Apart<3, 1>(mix));
  if (mix.pixel == 1) return body(Apart<1, 0>(mix));
  body(Apart<0, 0>(mix));
}

void to_inputs(const float *values, int64_t pixels, const RestorationMix &mix, int32_t *first, int32_t *second) {
  if (mix.count == 1) {
    for (int64_t i = 0; i < pixels; ++i)
      first[i] = input_of(values[i * mix.pixel] * mix.matrix[0]) & 0xffff, second[i] = 0;
    return;
  }
  std::array<float, 9> m;
  std::copy_n(mix.matrix, m.size(), m.begin());
  as_apart(mix, [&](const auto apart) {
    for (int64_t i = 0; i < pixels; ++i) {
      const float *p = values + i * apart.pixel;
      const float x = p[0], y = p[apart.channel], z = p[2 * apart.channel];
      const int32_t a = input_of(x * m[0] + y * m[1] + z * m[2]);
      const int32_t b = input_of(x * m[3] + y * m[4] + z * m[5]);
      const int32_t c = input_of(x * m[6] + y * m[7] + z * m[8]);
      first[i] = int32_t(uint32_t(a & 0xffff) | uint32_t(b) << 16), second[i] = c & 0xffff;
    }
  });
}

void add_correction(const int32_t *sums, int64_t plane, int64_t pixels, const RestorationMix &mix, float *values) {
  if (mix.count == 1) {
    for (int64_t i = 0; i < pixels; ++i) values[i * mix.pixel] += float(sums[i]) * mix.matrix[0];
    return;
  }
  std::array<float, 9> m;
  std::copy_n(mix.matrix, m.size(), m.begin());
  as_apart(mix, [&](const auto apart) {
    for (int64_t i = 0; i < pixels; ++i) {
      float *p = values + i * apart.pixel;
      const float a = float(sums[i]), b = float(sums[plane + i]), c = float(sums[2 * plane + i]);
      p[0] += a * m[0] + b * m[1] + c * m[2];
      p[apart.channel] += a * m[3] + b * m[4] + c * m[5];
      p[2 * apart.channel] += a * m[6] + b * m[7] + c * m[8];
    }
  });
}

}  // namespace

const RestorationKernel RestorationKernel::SGI_ISA{to_inputs, hidden_layer, last_layer, add_correction};

}  // namespace sgi
