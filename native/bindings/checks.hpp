// What bindings of several parts require of a network and of cells.
#pragma once
#include "bindings/arrays.hpp"
#include "model/network.hpp"

namespace sgi {

// log2 of the sides of cells, as shifts of whole pixels.
inline void require_cells(const Array<const int8_t, 1> &log_size) {
  for (size_t i = 0; i < log_size.size(); ++i)
    require(log_size.data()[i] >= 0 && log_size.data()[i] < 24, "log_size must be 0..23");
}

template <class A>
auto copy(const A &array) {
  return std::vector(array.data(), array.data() + array.size());
}

// The network of w1 [hidden, inputs], b1 [hidden], w2 [outputs, hidden], b2 [outputs].
inline IntNetwork network_of(const Array<const int64_t, 2> &w1, const Array<const int64_t, 1> &b1,
                             const Array<const int64_t, 2> &w2, const Array<const int64_t, 1> &b2, int shift,
                             int predicted) {
  const size_t hidden = w1.shape(0), outputs = w2.shape(0);
  require(b1.shape(0) == hidden && w2.shape(1) == hidden && b2.shape(0) == outputs, "weights do not fit each other");
  require(predicted >= 0 && size_t(predicted) <= outputs, "there are fewer outputs than predictions");
  IntNetwork network{copy(w1),    copy(b1),     copy(w2),  copy(b2), int(w1.shape(1)),
                     int(hidden), int(outputs), predicted, shift};
  network.require_exact();
  return network;
}

}  // namespace sgi
