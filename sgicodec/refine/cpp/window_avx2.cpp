#define LANES 8
#include "window_impl.hpp"

namespace sgi {
const WindowKernel &avx2_window_kernel() {
  static const WindowKernel kernel{draw, add_scaled, inner, subtract, changes};
  return kernel;
}
}  // namespace sgi
