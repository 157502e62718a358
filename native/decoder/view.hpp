// A view: a region of the picture at a scale, and the part of the overview that shows the same.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

namespace sgi {

// Where it starts in the picture, output pixels for each of the picture's, and its size in output pixels.
struct PictureView {
  double x, y, sx, sy;
  int64_t columns, rows;

  // Whether both show the picture at the same place and scale, whatever their sizes.
  bool is_aligned(const PictureView &other) const {
    return x == other.x && y == other.y && sx == other.sx && sy == other.sy;
  }
  // Whether its pixels are the picture's.
  bool is_plain() const;
};

// The part of a view whose pixels have their centres in the picture, and its first column and row.
struct InnerView {
  PictureView view;
  int64_t left, top;
};
InnerView inner_view(const PictureView &view, int64_t width, int64_t height);

// A level of a pyramid: its size, and how many of the picture's pixels lie along the side of one of its own.
struct Level {
  int64_t width, height;
  double downsample;
};
// The picture, its half, its quarter ... down to 256 pixels.
std::vector<Level> levels_of(int64_t width, int64_t height);

// Width and height of a picture's overview.
Level overview_size(int64_t width, int64_t height);
// What of the picture's overview a view shows; none for one that shows more than the overview holds, and of an overview
// that is no smaller than the picture.
std::optional<PictureView> overview_view(int64_t width, int64_t height, const PictureView &view);

}  // namespace sgi
