// A hidden layer of restoration two rows and columns of outputs at a time, by Winograd's F(2 x 2, 3 x 3) (Lavin and
// Gray 2015): 16 products for each pair of inputs and such a square instead of 36. For restoration_kernels.cpp alone.
//
// Each of the 16 places of a square multiplies sums and differences of the 4 x 4 inputs around it, which have 16 bits
// where inputs are small, by fixed weights; sums and differences of the places are four times the layer's own sums.
// These wrap around on their way, and are exact in the end.
#pragma once
#include <cstdint>
#include <utility>

#include "model/hidden_values.hpp"

namespace sgi {
namespace {
namespace squares {

using narrow::vi;
using Halves = uint16_t __attribute__((vector_size(LANES * 4)));  // of two's complement
using Wrapping = uint32_t __attribute__((vector_size(LANES * 4)));

constexpr int kVectors = 2, kOutputs = 4;  // computed at once: what there are registers for
constexpr int kAcross = kVectors * LANES;  // squares side by side
constexpr int kBiased = 5;                 // the place that all four outputs add
static_assert(kRestorationColumns % (2 * kAcross) == 0, "a strip must hold whole vectors of squares");
static_assert(kSquareOutputs % kOutputs == 0, "layers must have whole groups of outputs");

using Products = vi[kSquarePlaces][kOutputs][kVectors];
using Lanes = std::make_integer_sequence<int, LANES>;

template <int... I>
inline vi shuffled(vi a, vi b, std::integer_sequence<int, I...>) {
#if defined(__clang__)
  return __builtin_shufflevector(a, b, I...);
#else
  return __builtin_shuffle(a, b, vi{I...});
#endif
}

// Every other lane of two vectors, from the first one on or from the second.
template <int FIRST, int... I>
inline vi every_other(vi a, vi b, std::integer_sequence<int, I...>) {
  return shuffled(a, b, std::integer_sequence<int, FIRST + 2 * I...>{});
}

// Lanes of two vectors in turn, from this one of each on.
template <int FIRST, int... I>
inline vi in_turn(vi a, vi b, std::integer_sequence<int, I...>) {
  return shuffled(a, b, std::integer_sequence<int, FIRST + I / 2 + I % 2 * LANES...>{});
}

inline vi plus(vi a, vi b) { return (vi)((Halves)a + (Halves)b); }
inline vi less(vi a, vi b) { return (vi)((Halves)a - (Halves)b); }

// What the places of squares multiply, of a pair of inputs; `step` from one place to the next.
inline void to_places(const int32_t *in, int64_t step, vi *places) {
  for (int v = 0; v < kVectors; ++v) {
    vi across[4][4];
    for (int row = 0; row < 4; ++row) {
      const int32_t *p = in + row * kRestorationStride + 2 * v * LANES;
      const vi near[2] = {narrow::load(p), narrow::load(p + LANES)};
      const vi far[2] = {narrow::load(p + 2), narrow::load(p + 2 + LANES)};
      const vi first = every_other<0>(near[0], near[1], Lanes{}), second = every_other<1>(near[0], near[1], Lanes{});
      const vi third = every_other<0>(far[0], far[1], Lanes{}), fourth = every_other<1>(far[0], far[1], Lanes{});
      across[row][0] = less(first, third);
      across[row][1] = plus(second, third);
      across[row][2] = less(third, second);
      across[row][3] = less(second, fourth);
    }
    for (int i = 0; i < 4; ++i) {
      places[i * step + v] = less(across[0][i], across[2][i]);
      places[(4 + i) * step + v] = plus(across[1][i], across[2][i]);
      places[(8 + i) * step + v] = less(across[2][i], across[1][i]);
      places[(12 + i) * step + v] = less(across[1][i], across[3][i]);
    }
  }
}

// Of a group of outputs, over all pairs of inputs.
template <bool FUSED>
inline void multiply(const LayerView &layer, int first, const vi *places, Products &products) {
  const int outputs = layer.blocks * kRestorationBlock;
  for (int place = 0; place < kSquarePlaces; ++place) {
    vi sum[kOutputs][kVectors];
    for (int o = 0; o < kOutputs; ++o)
      for (vi &one : sum[o]) one = vi{} + (place == kBiased ? 4 * layer.biases[first + o] : 0);
    for (int pair = 0; pair < layer.pairs; ++pair) {
      const int at = place * layer.pairs + pair;
      for (int o = 0; o < kOutputs; ++o)
        for (int v = 0; v < kVectors; ++v) {
          sum[o][v] = narrow::add_products<FUSED>(sum[o][v], places[at * kVectors + v],
                                                  vi{} + layer.squares[at * outputs + first + o]);
          keep_order(sum[o][v]);
        }
    }
    for (int o = 0; o < kOutputs; ++o)
      for (int v = 0; v < kVectors; ++v) products[place][o][v] = sum[o][v];
  }
}

// Four times the sums of an output: [rows, columns] of the squares of a vector.
inline void add_up(const Products &products, int output, int v, vi sums[2][2]) {
  const auto of = [&](int row, int column) { return (Wrapping)products[4 * row + column][output][v]; };
  Wrapping part[2][4];
  for (int column = 0; column < 4; ++column) {
    part[0][column] = of(0, column) + of(1, column) + of(2, column);
    part[1][column] = of(1, column) - of(2, column) - of(3, column);
  }
  for (int row = 0; row < 2; ++row) {
    sums[row][0] = (vi)(part[row][0] + part[row][1] + part[row][2]);
    sums[row][1] = (vi)(part[row][1] - part[row][2] - part[row][3]);
  }
}

// Stores the hidden values of a group of outputs, `plane` from one pair to the next.
inline void store(const Products &products, int shift, int64_t plane, int32_t *out, vi &bits) {
  for (int v = 0; v < kVectors; ++v)
    for (int o = 0; o < kOutputs; o += 2) {
      vi even[2][2], odd[2][2];
      add_up(products, o, v, even), add_up(products, o + 1, v, odd);
      for (int row = 0; row < 2; ++row) {
        vi pairs[2];
        for (int i = 0; i < 2; ++i)
          bits |= pairs[i] = pair_of(activation(even[row][i], shift + 2), activation(odd[row][i], shift + 2));
        int32_t *to = out + o / 2 * plane + row * kRestorationStride + 2 * v * LANES;
        narrow::store(to, in_turn<0>(pairs[0], pairs[1], Lanes{}));
        narrow::store(to + LANES, in_turn<LANES / 2>(pairs[0], pairs[1], Lanes{}));
      }
    }
}

// As RestorationKernel::hidden, for a layer with squares and small inputs.
template <bool FUSED>
bool layer_as(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, int32_t *out) {
  const int64_t plane_in = (rows + 2) * kRestorationStride, plane = rows * kRestorationStride;
  vi places[kSquarePlaces * kSquareInputs / 2 * kVectors];
  Products products;
  vi bits{};
  for (int64_t next = 0; next < rows; next += 2) {
    const int64_t row = next + 2 > rows ? rows - 2 : next;  // of an odd number the last but one again
    for (int64_t x = 0; x < columns; x += 2 * kAcross) {
      const int64_t at = row * kRestorationStride + x;
      for (int pair = 0; pair < layer.pairs; ++pair)
        to_places(in + pair * plane_in + at, int64_t(layer.pairs) * kVectors, places + pair * kVectors);
      for (int first = 0; first < layer.blocks * kRestorationBlock; first += kOutputs) {
        multiply<FUSED>(layer, first, places, products);
        store(products, layer.shift, plane, out + first / 2 * plane + at, bits);
      }
    }
  }
  return is_small(bits);
}

}  // namespace squares
}  // namespace
}  // namespace sgi
