#include "model/int_network.hpp"

#include <algorithm>
#include <cstdlib>

#include "base/error.hpp"

namespace sgi {
namespace {

int64_t largest(const std::vector<int64_t> &values) {
  int64_t found = 0;
  for (const int64_t value : values) found = std::max(found, std::abs(value));
  return found;
}

// The largest sum of absolute values of a row.
int64_t largest_row(const std::vector<int64_t> &weights, int rows, int columns) {
  int64_t found = 0;
  for (int row = 0; row < rows; ++row) {
    int64_t sum = 0;
    for (int column = 0; column < columns; ++column) sum += std::abs(weights[size_t(row) * size_t(columns) + column]);
    found = std::max(found, sum);
  }
  return found;
}

}  // namespace

void IntNetwork::require_exact() const {
  constexpr double kExact = double(int64_t(1) << 53);
  const int64_t first = largest_row(w1, hidden, inputs) * kInputLimit + (largest(b1) << kInputBits);
  const int64_t second = largest_row(w2, outputs, hidden) * kHiddenLimit + (largest(b2) << kInputBits);
  if (std::max(double(first), double(second) * kPerOctave) >= kExact || shift < 2 || shift > 20)
    throw Error(Fault::corrupt, "context model: weights too large to be evaluated exactly");
}

}  // namespace sgi
