#define LANES 8
#include "kernel_impl.hpp"

namespace sgi {
const TileKernel &avx2_kernel() {
  static const TileKernel kernel{forward, compare, backward, multiply_add, "avx2", LANES};
  return kernel;
}
}  // namespace sgi
