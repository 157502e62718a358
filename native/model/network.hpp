// MLP_p in integers (docs/format.md, "MLP_p"): y = W2 clip((W1 x + 64 b1) >> shift) + 64 b2.
//
// The caller bounds the weights so that every partial sum stays below 2^53.
#pragma once
#include <cstdint>
#include <memory>

#include "base/isa.hpp"
#include "model/constants.hpp"

namespace sgi {

struct NetworkWeights {
  const int64_t *w1;  // [hidden, inputs]
  const int64_t *b1;  // [hidden]
  const int64_t *w2;  // [outputs, hidden]
  const int64_t *b2;  // [outputs]
  int inputs, hidden, outputs;
  int predicted;  // U: outputs are U means, U scales, and refinements
  int shift;
};

// Weights made ready for one instruction set, to be evaluated many times.
class Network {
 public:
  Network(const NetworkWeights &weights, Isa isa);
  ~Network();

  int outputs() const;
  int64_t scratch_size() const;  // numbers that an evaluation writes while it runs
  // Evaluates n rows of inputs, `stride` apart, into out [n, outputs]: means in 2^-8 base steps, scales and refinements
  // in sixths of an octave.
  void evaluate(const int16_t *rows, int64_t stride, int64_t n, double *scratch, int64_t *out) const;

 private:
  struct Packed;
  std::unique_ptr<Packed> packed_;
};

// The same once, on several threads.
void evaluate_network(const NetworkWeights &weights, const int16_t *rows, int64_t stride, int64_t n, int threads,
                      Isa isa, int64_t *out);

}  // namespace sgi
