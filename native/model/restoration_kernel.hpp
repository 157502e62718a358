// What restoration needs of an instruction set: its layers, and channels on their way in and out.
#pragma once
#include <cstdint>

namespace sgi {

constexpr int kRestorationMost = 32767;   // of an input or a hidden value
constexpr int kRestorationColumns = 128;  // of a strip, at most, with what hidden layers need beside it
constexpr int kRestorationStride = kRestorationColumns + 16;  // of a row: what is read behind a strip is there

constexpr int kRestorationTaps = 9, kRestorationBlock = 4;  // outputs are padded to whole blocks
constexpr int kRestorationLast = 3;                         // outputs of the last layer

// Of squares of two rows and columns of outputs (model/restoration_squares.hpp): their places, what the inputs of a
// layer and its outputs must be whole groups of, and the most inputs; and what inputs may be.
constexpr int kSquarePlaces = 16, kSquareOutputs = 4, kSquareInputs = 32, kRestorationSmall = 8191;

// Two consecutive inputs have one 32-bit number, the first in its lower half; so do their weights.
struct LayerView {
  int pairs, blocks, shift;
  const int32_t *weights;  // [blocks, pairs, kRestorationTaps, kRestorationBlock]
  const int32_t *biases;   // [blocks * kRestorationBlock], times 64
  const int32_t *squares;  // [kSquarePlaces, pairs, blocks * kRestorationBlock], null where there are none
};

// Operations are rounded by themselves, none fused: all instruction sets give the same.
struct RestorationKernel {
  // The inputs of the network for pixels side by side, of which `channels`, 1 or 3, have rows `plane` apart: the first
  // two in one number, the third in the other.
  void (*inputs)(const float *row, int64_t plane, int channels, int64_t pixels, float scale, int32_t *first,
                 int32_t *second);
  // in [pairs, rows + 2, stride]: pairs of values; out [2 blocks, rows, stride]: pairs of hidden values. small: whether
  // inputs are within 0 ... kRestorationSmall. Returns whether outputs are; rows must be two at least. As many
  // columns as are asked for are sound, of at most kRestorationColumns.
  bool (*hidden)(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, bool small, int32_t *out);
  // The same for the last layer; out [kRestorationLast, rows, stride]: sums.
  void (*last)(const LayerView &layer, const int32_t *in, int64_t rows, int64_t columns, int32_t *out);
  // Writes what values of pixels side by side are with sums times `scale`; `restored` may be `values`.
  void (*add)(const int32_t *sums, int64_t pixels, float scale, const float *values, float *restored);
  static const RestorationKernel portable, avx2, avx512;
};

}  // namespace sgi
