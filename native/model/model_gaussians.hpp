// From the attributes of a tile to the Gaussians that draw it, for every specification (docs/format.md, "Drawing").
#pragma once
#include <cstdint>
#include <vector>

#include "base/isa.hpp"
#include "model/seed_gaussians.hpp"
#include "model/spec.hpp"

namespace sgi {

// MLP_c or MLP_Sigma: w1 [w, D], b1 [w], w2 [O, w], b2 [O]; all empty for none.
struct DecoderWeights {
  std::vector<float> w1, b1, w2, b2;
};

struct ModelSeeds {
  const int32_t *corner;   // [N, 2] pixels
  const int8_t *log_size;  // [N]
  const int64_t *decoded;  // [N, d_A] attributes in units of 2^-24
  int64_t count;
};

// All N K of them, into `out`.
void model_gaussians(const ModelSpec &spec, const ModelSeeds &seeds, const DecoderWeights &colours,
                     const DecoderWeights &shapes, int threads, Isa isa, const SeedGaussians &out);

}  // namespace sgi
