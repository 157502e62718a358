// A view: a region of the picture at a scale, and the part of the overview that shows the same.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "bitstream/header.hpp"

namespace sgi {

// Where it starts in the picture, output pixels for each of the picture's, and its size in output pixels.
struct PictureView {
  double x, y, sx, sy;
  int64_t columns, rows;
};

// A level of a pyramid: its size, and how many of the picture's pixels lie along the side of one of its own.
struct Level {
  int64_t width, height;
  double downsample;
};

}  // namespace sgi
