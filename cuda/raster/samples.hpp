// From a rendered image to samples, a thread for each pixel: what lies behind is added, values are mapped and rounded,
// channels interleaved. native/raster computes.
#pragma once
#include "base/sample.hpp"
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"
#include "raster/sample_values.hpp"

namespace sgi {

constexpr int kSampleThreads = 256;

namespace {

inline float value_at(const SampleArguments &a, int channel, int row, int column) {
  const int64_t pixel = (int64_t(channel) * a.height + row) * a.width + column;
  float value = a.image[pixel];
  for (int t = 0; t < a.taps; ++t) {
    const int64_t line = int64_t(channel) * a.count + a.top[row] + t;
    value += a.lines[line * a.width + column] * a.down[int64_t(row) * a.taps + t];
  }
  return a.planes ? value + a.planes[pixel] : value;
}

inline void store_sample(const SampleArguments &a, int64_t at, float value) {
  switch (SampleType(a.type)) {
    case SampleType::u8: static_cast<uint8_t *>(a.out)[at] = stored<uint8_t>(value); break;
    case SampleType::u16: static_cast<uint16_t *>(a.out)[at] = stored<uint16_t>(value); break;
    default: static_cast<float *>(a.out)[at] = value;
  }
}

}  // namespace

SGI_KERNEL(store_samples, kSampleThreads, SampleArguments) {
  block.each([&](int t) {
    const int64_t pixel = int64_t(block.index()) * kSampleThreads + t;
    if (pixel >= int64_t(a.width) * a.height) return;
    const int row = int(pixel / a.width), column = int(pixel % a.width);
    for (int c = 0; c < a.channels; ++c) {
      const float value = value_at(a, c, row, column);
      store_sample(a, pixel * a.channels + c, a.clip ? mapped(value, a.low[c], a.span[c]) : value);
    }
  });
}

}  // namespace sgi
