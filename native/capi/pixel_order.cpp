#include "capi/pixel_order.hpp"

#include <cmath>
#include <type_traits>
#include <utility>

namespace sgi::capi {
namespace {

template <class T>
struct Pixel {
  T red, green, blue, alpha;
};

template <class T>
Pixel<T> pixel_of(ChannelLayout layout, const T *from, T opaque) {
  switch (layout) {
    case ChannelLayout::gray: return {from[0], from[0], from[0], opaque};
    case ChannelLayout::gray_alpha: return {from[0], from[0], from[0], from[1]};
    case ChannelLayout::rgb: return {from[0], from[1], from[2], opaque};
    default: return {from[0], from[1], from[2], from[3]};
  }
}

int channels_of(ChannelLayout layout) {
  return layout == ChannelLayout::gray         ? 1
         : layout == ChannelLayout::gray_alpha ? 2
         : layout == ChannelLayout::rgb        ? 3
                                               : 4;
}

// Rounded to nearest; 0 where alpha is 0, whatever the colour.
template <class T>
T weighed(T colour, T alpha, T opaque) {
  if constexpr (std::is_floating_point_v<T>)
    return alpha == 0 ? 0 : colour * alpha;
  else
    return T((uint64_t(colour) * alpha + opaque / 2) / opaque);
}

}  // namespace

template <class T>
void reorder(const PixelOrder &order, T *row, int64_t columns, T opaque) {
  const int channels = channels_of(order.layout);
  for (int64_t column = columns; column-- > 0;) {  // from the last one: four samples take the place of fewer
    Pixel<T> pixel = pixel_of(order.layout, row + column * channels, opaque);
    if (order.is_premultiplied)
      for (T *colour : {&pixel.red, &pixel.green, &pixel.blue}) *colour = weighed(*colour, pixel.alpha, opaque);
    if (order.is_bgra) std::swap(pixel.red, pixel.blue);
    T *const to = row + column * 4;
    to[0] = pixel.red, to[1] = pixel.green, to[2] = pixel.blue, to[3] = pixel.alpha;
  }
}

template <class T>
void find_nodata(const T *row, int64_t columns, int channels, int colours, double nodata, uint8_t *empty) {
  const auto is_nodata = [&](T sample) {
    return double(sample) == double(T(nodata)) || (std::isnan(nodata) && std::isnan(double(sample)));
  };
  for (int64_t column = 0; column < columns; ++column) {
    const T *const pixel = row + column * channels;
    empty[column] = 1;
    for (int colour = 0; colour < colours; ++colour) empty[column] &= uint8_t(is_nodata(pixel[colour]));
  }
}

template void reorder(const PixelOrder &, uint8_t *, int64_t, uint8_t);
template void reorder(const PixelOrder &, uint16_t *, int64_t, uint16_t);
template void reorder(const PixelOrder &, float *, int64_t, float);
template void find_nodata(const uint8_t *, int64_t, int, int, double, uint8_t *);
template void find_nodata(const uint16_t *, int64_t, int, int, double, uint8_t *);
template void find_nodata(const float *, int64_t, int, int, double, uint8_t *);

}  // namespace sgi::capi
