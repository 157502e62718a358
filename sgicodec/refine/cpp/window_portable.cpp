#define LANES 4
#include "window_impl.hpp"

namespace sgi {
const WindowKernel &portable_window_kernel() {
  static const WindowKernel kernel{draw, add_scaled, inner, subtract, changes};
  return kernel;
}
}  // namespace sgi
