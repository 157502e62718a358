#define LANES 16
#include "window_impl.hpp"

namespace sgi {
const WindowKernel &avx512_window_kernel() {
  static const WindowKernel kernel{draw, add_scaled, inner, subtract, changes};
  return kernel;
}
}  // namespace sgi
