#define LANES 4
#include "kernel_impl.hpp"

namespace sgi {
const TileKernel &portable_kernel() {
  static const TileKernel kernel{forward, compare, backward, multiply_add, "portable", LANES};
  return kernel;
}
}  // namespace sgi
