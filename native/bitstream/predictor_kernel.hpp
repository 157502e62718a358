// The arithmetic of a predictor of samples (bitstream/sample_predictor.hpp): weighted least squares over a few inputs.
#pragma once

namespace sgi {

constexpr int kPredictorInputs = 30;  // at most
constexpr int kPredictorRow = 32;     // values that stand beside each other: inputs, what is predicted, zeros

// Every operation is rounded by itself, none fused, in one order: all instruction sets give the same.
struct PredictorKernel {
  // Adds to sums [inputs + 1, kPredictorRow], of whose rows the part from the diagonal on counts, the products of
  // values [kPredictorRow], times a weight.
  void (*learn)(float *sums, const float *values, float weight, int inputs);
  // Solves for weights [inputs], rounded at the end, by the sums of a segment and of those beside it, drawn to `prior`.
  void (*solve)(const float *own, const float *left, const float *right, const double *prior, int inputs,
                float *weights);
  static const PredictorKernel portable, avx2, avx512;
};

}  // namespace sgi
