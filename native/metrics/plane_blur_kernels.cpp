#include "metrics/maps.hpp"
#include "metrics/plane_blur_kernel.hpp"
#include "metrics/rows.hpp"

namespace sgi {
namespace {

constexpr int64_t kMargin = kRowPadding;  // to each side of the scratch row

void add(const float *centre, int64_t stride, int64_t width, int reach, const float *down, const float *across,
         const float *before, const float *after, float *out, float *scratch) {
  float *const row = scratch + kMargin;
  const float *const first = centre - reach * stride;
  for (int64_t x = -kMargin; x < padded(width) + kMargin; x += LANES) {
    vf sum{};
    for (int i = 0; i <= 2 * reach; ++i) sum += down[i] * load(first + i * stride + x);
    store(row + x, sum * load(before + x));
  }
  for (int64_t x = 0; x < padded(width); x += LANES) {
    vf sum = across[0] * load(row + x);
    for (int i = 1; i <= reach; ++i) sum += across[i] * (load(row + x - i) + load(row + x + i));
    store(out + x, load(out + x) + zero_unless(inside(x, width), sum * load(after + x)));
  }
}

}  // namespace

const PlaneBlurKernel PlaneBlurKernel::SGI_ISA{sgi::add};

}  // namespace sgi
