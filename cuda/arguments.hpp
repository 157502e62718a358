// What kernels are called with. Python reads these structs (sgicodec/cuda/structures.py): one field a line, of the
// types below; no field but these.
#pragma once
#include <cstdint>

namespace sgi {

// What a call says of a picture of Gaussians, and the memory that its kernels share. Pairs are (tile, Gaussian); a slot
// is a pair's place in the Gaussian's order.
struct RasterArguments {
  const float *means;
  const float *covariances;
  const float *colours;
  int32_t gaussians;
  int32_t x0;
  int32_t y0;
  int32_t width;
  int32_t height;
  float cutoff;
  float weight;
  int32_t capacity;
  int32_t sort_blocks;
  int32_t shift;
  void *splats;
  int32_t *slot_start;
  int32_t *owner;
  uint32_t *keys;
  uint32_t *slots;
  uint32_t *keys_out;
  uint32_t *slots_out;
  int32_t *digits;
  int32_t *tile_start;
  float *partials;
  const float *target;
  const float *weights;
  float *image;
  double *errors;
  float *grad_means;
  float *grad_covariances;
  float *grad_colours;
};

// An exclusive sum over `count` numbers in place; behind them their total.
struct ScanArguments {
  int32_t *values;
  int32_t *totals;
  int32_t count;
};

// A product of a matrix, whose element (r, c) is weights[r * row_step + c * column_step], with rows [columns, count],
// a seed in each column. bias: of each row; passes [rows, count]: where it is not positive, the product is 0; either
// may lack.
struct ProductArguments {
  const float *weights;
  const float *bias;
  const float *input;
  const float *passes;
  float *out;
  int32_t rows;
  int32_t columns;
  int32_t row_step;
  int32_t column_step;
  int32_t count;
  int32_t adds;
  int32_t clips;
};

// Sums over seeds, a row of `partials` [chunks, width] for each chunk of them: of up[r] input[c] at
// weights_at + r * row_step + c, of up[r] at bias_at + r; `sums` [width] in the end.
struct SumArguments {
  const float *up;
  const float *input;
  float *partials;
  float *sums;
  int32_t rows;
  int32_t columns;
  int32_t row_step;
  int32_t weights_at;
  int32_t bias_at;
  int32_t width;
  int32_t count;
  int32_t chunk;
  int32_t chunks;
};

// A step of seeds that hold features: arrays as in native/fit/feature_kernel.hpp, and rows [.., count] of what a seed
// has, which lie side by side.
struct FeatureArguments {
  int32_t count;
  int32_t per_seed;
  int32_t channels;
  int32_t features;
  int32_t hidden;
  int32_t context_hidden;
  int32_t resolutions;
  int32_t entry_features;
  int32_t entries;
  int32_t rounding;
  int32_t priced;
  uint32_t key;
  uint32_t mirror;
  float scale;
  float share;
  float price;
  const int32_t *half_pixels;
  const int32_t *entry;
  const float *weight;
  const int32_t *read_start;
  const int32_t *reads;
  const int32_t *table_start;
  const float *steps;
  const int8_t *signs;
  const float *theta;
  const float *sign_slopes;
  const float *trained;
  float *values;
  float *drawn;
  float *slopes;
  float *inputs;
  const float *said_context;
  float *up_context;
  const float *said_colour;
  const float *said_shape;
  float *up_colour;
  float *up_shape;
  const float *hash_slopes;
  float *bits;
  float *bit_rows;
  float *tables;
  float *means;
  float *covariances;
  float *colours;
  const float *grad_means;
  const float *grad_covariances;
  const float *grad_colours;
};

}  // namespace sgi
