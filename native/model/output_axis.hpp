// Where the pixels of a view lie along one axis of a tile.
#pragma once
#include <cmath>
#include <cstdint>

namespace sgi {

// Output pixel i < count has its centre at (offset + first + i + 1/2) / scale in the tile. Offsets are whole multiples
// of 2^-16: what two views show of the same output pixels is the same to the last bit.
struct OutputAxis {
  double offset, scale;  // offset: 0 <= offset < 1
  int64_t first, count;

  OutputAxis() = default;
  // Of a view that begins at `start` in the tile, and of it the pixels from `first_of_view` on.
  OutputAxis(double start, double view_scale, int64_t first_of_view, int64_t pixels)
      : scale(view_scale), count(pixels) {
    const double at = std::floor(start * scale * kParts + 0.5) / kParts, whole = std::floor(at);
    offset = at - whole;
    first = int64_t(whole) + first_of_view;
  }
  // In the tile, of a place inside an output pixel; 0 <= inside < 1. What is added to `inside` is exact, so that the
  // same place has the same number whichever pixel is the first.
  double place(int64_t pixel, double inside) const { return (offset + double(first + pixel) + inside) / scale; }
  double centre(int64_t pixel) const { return place(pixel, 0.5); }
  // Among output pixels, of a place in the tile.
  double pixel_at(double place) const { return place * scale - offset - double(first); }
  // Whether its pixels are the tile's.
  bool is_plain() const { return scale == 1 && offset == 0; }

 private:
  static constexpr double kParts = 65536;
};

}  // namespace sgi
