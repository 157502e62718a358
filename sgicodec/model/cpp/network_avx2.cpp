#define LANES 8
#include "network_narrow_impl.hpp"
#include "network_wide_impl.hpp"

namespace sgi {
const NetworkKernel &network_avx2() {
  static const NetworkKernel kernel{narrow::evaluate, wide::evaluate};
  return kernel;
}
}  // namespace sgi
