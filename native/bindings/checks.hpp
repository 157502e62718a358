// What bindings of several parts require of a network and of steps.
#pragma once
#include "bindings/arrays.hpp"
#include "model/context.hpp"
#include "model/network.hpp"

namespace sgi {

// log2 of the sides of cells, as shifts of whole pixels.
inline void require_cells(const Array<const int8_t, 1> &log_size) {
  for (size_t i = 0; i < log_size.size(); ++i)
    require(log_size.data()[i] >= 0 && log_size.data()[i] < 24, "log_size must be 0..23");
}

// A view of w1 [hidden, inputs], b1 [hidden], w2 [outputs, hidden], b2 [outputs].
inline NetworkWeights network_weights(const Array<const int64_t, 2> &w1, const Array<const int64_t, 1> &b1,
                                      const Array<const int64_t, 2> &w2, const Array<const int64_t, 1> &b2, int shift,
                                      int predicted) {
  const size_t hidden = w1.shape(0), outputs = w2.shape(0);
  require(b1.shape(0) == hidden && w2.shape(1) == hidden && b2.shape(0) == outputs, "weights do not fit each other");
  require(shift >= 2 && shift <= 20, "shift must be 2..20");
  require(predicted >= 0 && size_t(predicted) <= outputs, "there are fewer outputs than predictions");
  return {w1.data(), b1.data(), w2.data(), b2.data(), int(w1.shape(1)), int(hidden), int(outputs), predicted, shift};
}

// base [size, kLevels]: steps of a group; columns [size]: indices of predictions.
inline void require_plan(const Array<const int64_t, 2> &base, const Array<const int64_t, 1> &columns, int64_t gamma,
                         size_t predictions) {
  require(has_shape(base, columns.shape(0), kLevels) && gamma >= 0 && gamma < 64,
          "base must be [size, 8], gamma 0..63");
  for (size_t i = 0; i < base.size(); ++i)
    require(base.data()[i] >= 0 && base.data()[i] < kStepCount, "a base step is outside the table of steps");
  for (size_t j = 0; j < columns.shape(0); ++j)
    require(columns.data()[j] >= 0 && size_t(columns.data()[j]) < predictions, "columns must be predictions");
}

}  // namespace sgi
