// Compiled once per instruction set, with fused multiply-adds off. Only what is inline may be included here.
#include <cstring>

#include "finish.hpp"

namespace sgi {
namespace {

// row += factor * line for the 16 pixels from column x on, of which `width` bounds what may be read.
inline void add_line(float *row, const float *line, int64_t width, int x, float factor) {
  float part[kTile] = {};
  if (x < 0 || x + kTile > width) {
    for (int i = 0; i < kTile; ++i)
      if (x + i >= 0 && x + i < width) part[i] = line[x + i];
  } else {
    std::memcpy(part, line + x, sizeof part);
  }
  for (int i = 0; i < kTile; ++i) row[i] += part[i] * factor;
}

inline void clip_and_map(float *row, float low, float span) {
  for (int i = 0; i < kTile; ++i) {
    const float least = row[i] > 0.0f ? row[i] : 0.0f;  // also for not-a-number
    row[i] = (least < 1.0f ? least : 1.0f) * span + low;
  }
}

template <class T>
inline void convert(const float *row, float most, T *to) {
  constexpr float kMagic = 12582912.0f;  // 1.5 * 2^23: adding it leaves no fraction
  for (int i = 0; i < kTile; ++i) {
    const float rounded = (row[i] + kMagic) - kMagic;
    const float least = rounded > 0.0f ? rounded : 0.0f;
    to[i] = T(int32_t(least < most ? least : most));
  }
}

inline void convert(const float *row, float, float *to) { std::memcpy(to, row, kTile * sizeof(float)); }

template <int C, class T>
inline void interleave(const T *planes, int channels, int first, int last, T *to) {
  const int count = C ? C : channels;
  for (int x = first; x < last; ++x)
    for (int c = 0; c < count; ++c) *to++ = planes[c * kTile + x];
}

template <class T>
void write_row(const T *planes, int channels, int first, int last, T *to) {
  switch (channels) {
    case 1: interleave<1>(planes, 1, first, last, to); break;
    case 3: interleave<3>(planes, 3, first, last, to); break;
    case 4: interleave<4>(planes, 4, first, last, to); break;
    default: interleave<0>(planes, channels, first, last, to);
  }
}

template <class T>
void finish_as(float *tile, int channels, const TileRect &r, const Background &b, const Samples &s, float most) {
  T planes[kMostChannels * kTile];
  for (int y = r.row0; y < r.row1; ++y) {
    const int64_t down = int64_t(r.y) + y;
    for (int c = 0; c < channels; ++c) {
      float *row = tile + c * kTilePixels + y * kTile;
      for (int t = 0; t < (b.lines ? b.taps : 0); ++t)
        add_line(row, b.lines + (c * b.count + b.top[down] + t) * b.width, b.width, r.x, b.down[down * b.taps + t]);
      if (s.clip) clip_and_map(row, s.low[c], s.span[c]);
      convert(row, most, planes + c * kTile);
    }
    T *to = static_cast<T *>(s.first) + down * s.row_stride + int64_t(r.x + r.col0) * channels;
    write_row(planes, channels, r.col0, r.col1, to);
  }
}

void finish(float *tile, int channels, const TileRect &rect, const Background &background, const Samples &samples) {
  switch (samples.type) {
    case SampleType::u8: finish_as<uint8_t>(tile, channels, rect, background, samples, 255.0f); break;
    case SampleType::u16: finish_as<uint16_t>(tile, channels, rect, background, samples, 65535.0f); break;
    case SampleType::f32: finish_as<float>(tile, channels, rect, background, samples, 0.0f); break;
  }
}

}  // namespace
}  // namespace sgi
