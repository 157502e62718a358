#define LANES 4
#include "network_narrow_impl.hpp"
#include "network_wide_impl.hpp"

namespace sgi {
const NetworkKernel &network_portable() {
  static const NetworkKernel kernel{narrow::evaluate, wide::evaluate};
  return kernel;
}
}  // namespace sgi
