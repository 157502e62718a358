#define LANES 16
#include "network_narrow_impl.hpp"
#include "network_wide_impl.hpp"

namespace sgi {
const NetworkKernel &network_avx512() {
  static const NetworkKernel kernel{narrow::evaluate, wide::evaluate};
  return kernel;
}
}  // namespace sgi
