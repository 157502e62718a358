// MLP_p in integers (docs/format.md, "MLP_p"): y = W2 clip((W1 x + 64 b1) >> shift) + 64 b2.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "base/isa.hpp"
#include "model/network_kernel.hpp"

namespace sgi {

// The weights as they are shipped or coded.
struct IntNetwork {
  std::vector<int64_t> w1, b1, w2, b2;  // [hidden, inputs], [hidden], [outputs, hidden], [outputs]
  int inputs, hidden, outputs;
  int predicted;  // U: outputs are U means, U scales, and refinements
  int shift;

  // Throws Error (corrupt) if a sum could leave the integers that float64 holds exactly.
  void require_exact() const;
};

// Weights made ready for one instruction set, to be evaluated many times.
class Network {
 public:
  Network(const IntNetwork &weights, Isa isa);
  Network(const Network &) = delete;

  int outputs() const { return outputs_; }
  int64_t scratch_size() const;  // numbers that an evaluation writes while it runs
  // Evaluates n rows of inputs, `stride` apart, into out [n, outputs]: means in 2^-8 base steps, scales and refinements
  // in sixths of an octave.
  void evaluate(const int16_t *rows, int64_t stride, int64_t n, double *scratch, int64_t *out) const;

 private:
  const NetworkKernel &kernel_;
  const int outputs_;
  std::optional<IntNetwork> wide_;  // where the narrow one does not hold it
  std::vector<int32_t> w1_, b1_, w2_, b2_;
  NarrowNetwork narrow_{};
};

}  // namespace sgi
