// Channels of a picture become RGBA or BGRA, in the caller's buffer.
#pragma once
#include <cstdint>

#include "bitstream/header.hpp"

namespace sgi::capi {

struct PixelOrder {
  ChannelLayout layout;  // of what was drawn; not `multi`
  bool is_bgra, is_premultiplied;
};

// A row of `columns` pixels, T by T, that begins with what was drawn and has room for four samples of each.
template <class T>
void reorder(const PixelOrder &order, T *row, int64_t columns, T opaque);

// Sets `empty` where all colours of a pixel are nodata. `row`: pixels of `channels` samples, the first `colours` of
// which are colours.
template <class T>
void find_nodata(const T *row, int64_t columns, int channels, int colours, double nodata, uint8_t *empty);

}  // namespace sgi::capi
