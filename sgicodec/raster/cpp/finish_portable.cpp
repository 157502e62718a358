#define LANES 4
#include "finish_impl.hpp"

namespace sgi {
void finish_portable(const float *tile, int channels, const TileRect &rect, const Background &background,
                     const Samples &samples) {
  finish(tile, channels, rect, background, samples);
}
}  // namespace sgi
