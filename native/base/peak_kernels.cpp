#include "base/peak.hpp"
#include "base/vector.hpp"

namespace sgi {
namespace {

float multiply_add(int64_t rounds) {
  vf chain[kPeakChains];
  for (int i = 0; i < kPeakChains; ++i) chain[i] = iota() + float(i);
  const vf factor = vf{} + 0.5f, term = vf{} + 1.0f;
  for (int64_t round = 0; round < rounds; ++round)
#pragma GCC unroll 16
    for (int i = 0; i < kPeakChains; ++i) chain[i] = chain[i] * factor + term;
  vf sum{};
  for (int i = 0; i < kPeakChains; ++i) sum += chain[i];
  return sum[0];
}

}  // namespace

const PeakKernel PeakKernel::SGI_ISA{sgi::multiply_add};

}  // namespace sgi
