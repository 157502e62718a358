// Windows around Gaussians, and the order in which they may be worked on side by side.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "rdoq/window_kernel.hpp"

namespace sgi {

// What a picture still misses, target less drawn: [channels, height, row], of which `width` columns are the picture.
// Kernels read and write back up to kWindowPadding - 1 columns behind a window: `row` is that much longer.
struct Residual {
  float *samples;
  int channels, height, width;
  int64_t row;
  const float *weights;  // [height, row] of the pixels' squared errors, zero in the padding; nullptr where all are 1

  Plane plane(int channel, const Window &w) const {
    return {samples + (int64_t(channel) * height + w.y) * row + w.x, row};
  }
  WeightPlane weights_in(const Window &w) const { return {weights + int64_t(w.y) * row + w.x, row}; }
};

// The pixels whose centres lie within `reach` times a Gaussian's extents, moved by up to `shift` pixels.
Window window_around(const Splat &splat, float reach, float shift, const Residual &residual);

// The least window around both; an empty one does not count.
Window around_both(const Window &a, const Window &b);

// The part of a window around `inner`, with the same rows; it begins a whole number of vectors behind the window.
Window part_of(const Window &w, const Window &inner);

// Whether a Gaussian ends inside a window, or where the picture ends.
bool holds(const Window &w, const Splat &splat, const Residual &residual);

using Worker = std::function<void(int64_t)>;

// Calls a worker with every i of `order` whose window is not empty, with the result of one after the other: what
// touches is never worked on side by side, and always in this order. `make` gives each of several threads a worker.
void for_each_window(const std::vector<Window> &windows, const std::vector<int32_t> &order, const Residual &residual,
                     int threads, const std::function<Worker()> &make);

}  // namespace sgi
