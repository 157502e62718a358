#define LANES 16
#include "kernel_impl.hpp"

namespace sgi {
const TileKernel &avx512_kernel() {
  static const TileKernel kernel{forward, compare, backward, multiply_add, "avx512", LANES};
  return kernel;
}
}  // namespace sgi
