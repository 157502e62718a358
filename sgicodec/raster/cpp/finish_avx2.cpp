#define LANES 8
#include "finish_impl.hpp"

namespace sgi {
void finish_avx2(const float *tile, int channels, const TileRect &rect, const Background &background,
                 const Samples &samples) {
  finish(tile, channels, rect, background, samples);
}
}  // namespace sgi
