// The row filters of PNG (PNG 3, chapter 9).
#pragma once
#include <cstdint>

#include "base/isa.hpp"

namespace sgi {

struct PngFilterKernel {
  // Filters `count` rows of `size` bytes into out [count, 1 + size], the filter's number before each row. `above` is
  // the row before the first one, zeros at the top; `step` is the bytes of a pixel. The filter whose differences are
  // smallest on the first of every eight rows serves them all.
  void (*filter)(const uint8_t *rows, const uint8_t *above, int64_t count, int64_t size, int step, uint8_t *out);
  static const PngFilterKernel portable, avx2, avx512;
};

}  // namespace sgi
