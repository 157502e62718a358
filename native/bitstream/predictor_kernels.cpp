#include "base/isa.hpp"
#include "bitstream/predictor_kernel.hpp"

namespace sgi {
namespace {

constexpr int kRow = kPredictorRow;
constexpr double kBeside = 0.6;       // weight of the segments to the left and to the right
constexpr double kRidge = 4;          // by how much weights are drawn to the prior
constexpr double kLeastPivot = 1e-6;  // of an input's own sum; one that adds less to those before gets no weight

void add_products(float *sums, const float *values, float weight, int inputs) {
  for (int i = 0; i <= inputs; ++i, sums += kRow) {
    const float scaled = values[i] * weight;
    for (int j = i & ~7; j < kRow; ++j) sums[j] += scaled * values[j];
  }
}

// Cholesky, row by row, with what is predicted as the last column; the diagonal is kept inverted.
void solve_weights(const float *own, const float *left, const float *right, const double *prior, int inputs,
                   double *weights) {
  double matrix[kPredictorInputs * kRow], inverse[kPredictorInputs], least[kPredictorInputs];
  for (int i = 0; i < inputs * kRow; ++i) matrix[i] = double(own[i]) + kBeside * (double(left[i]) + double(right[i]));
  for (int i = 0; i < inputs; ++i) {
    double *row = matrix + i * kRow;
    row[i] += kRidge;
    row[inputs] += kRidge * prior[i];
    least[i] = kLeastPivot * row[i];
  }
  for (int k = 0; k < inputs; ++k) {
    double *row = matrix + k * kRow;
    inverse[k] = row[k] > least[k] ? 1 / __builtin_sqrt(row[k]) : 0;
    for (int j = k + 1; j <= inputs; ++j) row[j] *= inverse[k];
    for (int i = k + 1; i < inputs; ++i) {
      double *below = matrix + i * kRow;
      for (int j = i; j <= inputs; ++j) below[j] -= row[i] * row[j];
    }
  }
  for (int i = inputs - 1; i >= 0; --i) {
    weights[i] = matrix[i * kRow + inputs] * inverse[i];
    for (int k = 0; k < i; ++k) matrix[k * kRow + inputs] -= matrix[k * kRow + i] * weights[i];
  }
}

}  // namespace

const PredictorKernel PredictorKernel::SGI_ISA{add_products, solve_weights};

}  // namespace sgi
