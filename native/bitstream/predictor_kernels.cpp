#include "base/isa.hpp"
#include "base/vector.hpp"
#include "bitstream/predictor_kernel.hpp"

namespace sgi {
namespace {

constexpr int kRow = kPredictorRow;
constexpr double kBeside = 0.6;     // weight of the segments to the left and to the right
constexpr double kRidge = 4;        // by how much weights are drawn to the prior
constexpr double kMinPivot = 1e-6;  // of an input's own sum; one that adds less to those before gets no weight

// Adds products to rows from `begin` to `end`, in columns from `first` to `last`.
template <int first, int last>
inline void add_rows(float *sums, const float *values, float weight, int begin, int end) {
  constexpr int kVectors = (last - first) / LANES;
  vf columns[kVectors];
  for (int j = 0; j < kVectors; ++j) columns[j] = load(values + first + j * LANES);
  for (int i = begin; i < end; ++i) {
    const float scaled = values[i] * weight;
    for (int j = 0; j < kVectors; ++j) {
      float *at = sums + i * kRow + first + j * LANES;
      store(at, load(at) + scaled * columns[j]);
    }
  }
}

void add_products(float *sums, const float *values, float weight, int inputs) {
  constexpr int kHalf = kRow / 2;
  if (inputs < kHalf) return add_rows<0, kHalf>(sums, values, weight, 0, inputs + 1);
  add_rows<0, kRow>(sums, values, weight, 0, kHalf);
  add_rows<kHalf, kRow>(sums, values, weight, kHalf, inputs + 1);
}

// Gaussian elimination, with what is predicted as the last column.
void solve_weights(const float *own, const float *left, const float *right, const double *prior, int inputs,
                   float *weights) {
  alignas(64) double matrix[kPredictorInputs * kRow], shares[kPredictorInputs * kRow], found[kRow]{};
  double least[kPredictorInputs];
  const int end = (inputs & -kDoubles) + kDoubles;
  for (int i = 0; i < inputs; ++i)
    for (int j = i & -kDoubles; j < end; ++j) {
      const int at = i * kRow + j;
      matrix[at] = double(own[at]) + kBeside * (double(left[at]) + double(right[at]));
    }
  for (int i = 0; i < inputs; ++i) {
    double *row = matrix + i * kRow;
    row[i] += kRidge;
    row[inputs] += kRidge * prior[i];
    least[i] = kMinPivot * row[i];
  }
  for (int k = 0; k < inputs; ++k) {
    const double *row = matrix + k * kRow;
    const double inverse = row[k] > least[k] ? 1 / row[k] : 0;
    for (int i = k + 1; i < inputs; ++i) {
      const double share = row[i] * inverse;
      shares[i * kRow + k] = share;
      double *below = matrix + i * kRow;
      for (int j = i & -kDoubles; j < end; j += kDoubles) store(below + j, load(below + j) - share * load(row + j));
    }
    found[k] = row[inputs] * inverse;
  }
  for (int i = inputs - 1; i >= 0; --i) {
    const double weight = found[i];
    weights[i] = float(weight);
    const double *share = shares + i * kRow;
    for (int k = 0; k < i; ++k) found[k] -= share[k] * weight;
  }
}

}  // namespace

const PredictorKernel PredictorKernel::SGI_ISA{add_products, solve_weights};

}  // namespace sgi
