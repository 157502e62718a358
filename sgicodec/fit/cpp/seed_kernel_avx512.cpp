#define LANES 16
#include "seed_kernel_impl.hpp"

namespace sgi {
const SeedKernel &avx512_seed_kernel() {
  static const SeedKernel kernel{summarize, gather, multiply, forward, backward, LANES};
  return kernel;
}
}  // namespace sgi
