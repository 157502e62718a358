// A hidden layer of restoration two rows and columns of outputs at a time, by Winograd's F(2 x 2, 3 x 3) (Lavin and
// Gray 2015): 16 products for each pair of inputs and such a square instead of 36. For restoration_kernels.cpp alone.
//
// Each of the 16 places of a square multiplies sums and differences of the 4 x 4 inputs around it, which have 16 bits
// where inputs are small, by fixed weights. With these, four times the layer's own sums are those of
//   rows 0, 1 and 2 above,  rows 1 and 3 less row 2 below,  of places or, in a row, of what each column gives:
//   columns 0, 1 and 2 to the left,  columns 1 and 3 less column 2 to the right.
// They wrap around on their way, and are exact in the end.
#pragma once
#include <cstdint>
#include <utility>

#include "model/hidden_values.hpp"

namespace sgi {
namespace {
namespace squares {

using narrow::vi;
using narrow::Wrapping;
using Halves = uint16_t __attribute__((vector_size(LANES * 4)));  // of two's complement

constexpr int kVectors = 2, kOutputs = 4;  // computed at once: what there are registers for
constexpr int kAcross = kVectors * LANES;  // squares side by side
static_assert(kRestorationColumns % (2 * kAcross) == 0, "a strip must hold whole vectors of squares");
static_assert(kSquareOutputs % kOutputs == 0, "layers must have whole groups of outputs");

// Of a group of outputs, in the vectors of a row of squares.
using Sums = vi[kOutputs][kVectors];
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

// Adds what a place of squares multiplies, over all pairs of inputs.
template <bool FUSED>
inline void add_place(const LayerView &layer, int first, int place, const vi *places, Sums &sums) {
  const int outputs = layer.blocks * kRestorationBlock;
  const int32_t *weights = layer.squares + place * layer.pairs * outputs + first;
  const vi *values = places + place * layer.pairs * kVectors;
  for (int pair = 0; pair < layer.pairs; ++pair, weights += outputs, values += kVectors)
    for (int o = 0; o < kOutputs; ++o)
      for (int v = 0; v < kVectors; ++v) {
        sums[o][v] = narrow::add_products<FUSED>(sums[o][v], values[v], vi{} + weights[o]);
        keep(sums[o][v]);
      }
}

inline vi sum_of(vi a, vi b) { return (vi)((Wrapping)a + (Wrapping)b); }
inline vi difference_of(vi a, vi b) { return (vi)((Wrapping)a - (Wrapping)b); }

// What a row of places adds to the left and to the right column of outputs.
template <bool FUSED>
inline void add_row(const LayerView &layer, int first, int row, const vi *places, Sums &left, Sums &right) {
  for (int o = 0; o < kOutputs; ++o)
    for (int v = 0; v < kVectors; ++v)  // the bias goes to the place that all four outputs add, (1, 1)
      left[o][v] = vi{} + (row == 1 ? 4 * layer.biases[first + o] : 0), right[o][v] = vi{};
  add_place<FUSED>(layer, first, 4 * row + 1, places, left);
  add_place<FUSED>(layer, first, 4 * row + 2, places, right);
  for (int o = 0; o < kOutputs; ++o)
    for (int v = 0; v < kVectors; ++v) {
      const vi one = left[o][v], other = right[o][v];
      left[o][v] = sum_of(one, other), right[o][v] = difference_of(one, other);
    }
  add_place<FUSED>(layer, first, 4 * row, places, left);
  add_place<FUSED>(layer, first, 4 * row + 3, places, right);
}

// Stores the hidden values of a row of outputs of a group, `plane` from one pair to the next.
inline void store(const Sums &left, const Sums &right, int shift, int64_t plane, int32_t *out, vi &bits) {
  for (int v = 0; v < kVectors; ++v)
    for (int o = 0; o < kOutputs; o += 2) {
      const vi even = pair_of(activation(left[o][v], shift + 2), activation(left[o + 1][v], shift + 2));
      const vi odd = pair_of(activation(right[o][v], shift + 2), activation(right[o + 1][v], shift + 2));
      bits |= even | odd;
      int32_t *to = out + o / 2 * plane + 2 * v * LANES;
      narrow::store(to, in_turn<0>(even, odd, Lanes{}));
      narrow::store(to + LANES, in_turn<LANES / 2>(even, odd, Lanes{}));
    }
}

// Computes and stores both rows of outputs of a group.
template <bool FUSED>
inline void both_rows(const LayerView &layer, int first, const vi *places, int64_t plane, int32_t *out, vi &bits) {
  Sums upper[2], lower[2], row[2];
  add_row<FUSED>(layer, first, 0, places, upper[0], upper[1]);
  add_row<FUSED>(layer, first, 1, places, lower[0], lower[1]);
  add_row<FUSED>(layer, first, 2, places, row[0], row[1]);
  for (int side = 0; side < 2; ++side)
    for (int o = 0; o < kOutputs; ++o)
      for (int v = 0; v < kVectors; ++v) {
        const vi second = lower[side][o][v], third = row[side][o][v];
        upper[side][o][v] = sum_of(upper[side][o][v], sum_of(second, third));
        lower[side][o][v] = difference_of(second, third);
      }
  store(upper[0], upper[1], layer.shift, plane, out, bits);
  add_row<FUSED>(layer, first, 3, places, row[0], row[1]);
  for (int side = 0; side < 2; ++side)
    for (int o = 0; o < kOutputs; ++o)
      for (int v = 0; v < kVectors; ++v) lower[side][o][v] = sum_of(lower[side][o][v], row[side][o][v]);
  store(lower[0], lower[1], layer.shift, plane, out + kRestorationStride, bits);
}

// As RestorationKernel::hidden, for a layer with squares and small inputs.
template <bool FUSED>
bool layer_as(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, int32_t *out) {
  const int64_t plane_in = (rows + 2) * kRestorationStride, plane = rows * kRestorationStride;
  vi places[kSquarePlaces * kSquareInputs / 2 * kVectors];
  vi bits{};
  for (int64_t next = 0; next < rows; next += 2) {
    const int64_t row = next + 2 > rows ? rows - 2 : next;  // of an odd number the last but one again
    for (int64_t x = 0; x < columns; x += 2 * kAcross) {
      const int64_t at = row * kRestorationStride + x;
      for (int pair = 0; pair < layer.pairs; ++pair)
        to_places(in + pair * plane_in + at, int64_t(layer.pairs) * kVectors, places + pair * kVectors);
      for (int first = 0; first < layer.blocks * kRestorationBlock; first += kOutputs)
        both_rows<FUSED>(layer, first, places, plane, out + first / 2 * plane + at, bits);
    }
  }
  return is_small(bits);
}

}  // namespace squares
}  // namespace
}  // namespace sgi
