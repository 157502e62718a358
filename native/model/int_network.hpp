// The weights of MLP_p as they are shipped or coded (docs/format.md, "MLP_p").
#pragma once
#include <cstdint>
#include <vector>

#include "model/network.hpp"

namespace sgi {

struct IntNetwork {
  std::vector<int64_t> w1, b1, w2, b2;  // [hidden, inputs], [hidden], [outputs, hidden], [outputs]
  int inputs, hidden, outputs, predicted, shift;

  NetworkWeights view() const {
    return {w1.data(), b1.data(), w2.data(), b2.data(), inputs, hidden, outputs, predicted, shift};
  }
  // Throws Error (corrupt) if a sum could leave the integers that float64 holds exactly.
  void require_exact() const;
};

}  // namespace sgi
