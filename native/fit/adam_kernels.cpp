// The operations, their order and which of them are fused are those of torch's fused Adam, so that equal gradients give
// equal numbers: CMake keeps the compiler from fusing others in this file.
#include "fit/adam_kernel.hpp"
#include "fit/adam_move.hpp"

namespace sgi {
namespace {

void move_run(const AdamStep &step, const float *__restrict gradient, int64_t n, float *__restrict value,
              float *__restrict mean, float *__restrict square) {
  const AdamMove move(step);
  for (int64_t i = 0; i < n; ++i) move(gradient[i], value[i], mean[i], square[i]);
}

}  // namespace

const AdamKernel AdamKernel::SGI_ISA{&move_run};

}  // namespace sgi
