#define LANES 4
#include "network_impl.hpp"

namespace sgi {
void network_avx2(const PackedNetwork &net, const int16_t *rows, int64_t stride, int64_t n, double *scratch,
                int64_t *out) {
  evaluate(net, rows, stride, n, scratch, out);
}
}  // namespace sgi
