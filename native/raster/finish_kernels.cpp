// Finishing in vectors of LANES pixels (compiler vector extensions). CMake turns fused multiply-adds off for this file.
#ifdef __SSSE3__
#include <immintrin.h>
#endif

#include "raster/finish_kernel.hpp"

namespace sgi {
namespace {

using Row = float __attribute__((vector_size(LANES * 4)));
using Ints = int32_t __attribute__((vector_size(LANES * 4)));
using Words = uint16_t __attribute__((vector_size(LANES * 2)));
using Bytes = uint8_t __attribute__((vector_size(LANES)));

constexpr int kStrip = 16;  // columns that are finished at once

inline Row load(const float *p) {
  Row row;
  __builtin_memcpy(&row, p, sizeof row);
  return row;
}

// The values of a line from column x on; zeros where there is none.
inline Row load_part(const float *line, int64_t width, int x) {
  if (x >= 0 && x + LANES <= width) return load(line + x);
  Row row{};
  for (int i = 0; i < LANES; ++i)
    if (x + i >= 0 && x + i < width) row[i] = line[x + i];
  return row;
}

inline Row clipped(Row row, float most) {
  row = row > 0.0f ? row : Row{};  // also not-a-number
  return row < most ? row : Row{} + most;
}

inline Ints rounded(Row row, float most) {
  constexpr float kMagic = 12582912.0f;  // 1.5 * 2^23: adding it leaves no fraction
  return __builtin_convertvector(clipped((row + kMagic) - kMagic, most), Ints);
}

inline void convert(Row row, uint8_t *to) {
  const Bytes samples = __builtin_convertvector(rounded(row, 255.0f), Bytes);
  __builtin_memcpy(to, &samples, sizeof samples);
}

inline void convert(Row row, uint16_t *to) {
  const Words samples = __builtin_convertvector(rounded(row, 65535.0f), Words);
  __builtin_memcpy(to, &samples, sizeof samples);
}

inline void convert(Row row, float *to) { __builtin_memcpy(to, &row, sizeof row); }

template <int C, class T>
inline void interleave(const T *planes, int channels, int first, int last, T *to) {
  const int count = C ? C : channels;
  for (int x = first; x < last; ++x)
    for (int c = 0; c < count; ++c) *to++ = planes[c * kStrip + x];
}

#ifdef __SSSE3__
// Which pixel of channel c byte i of the interleaved part p shows; 0x80 for none.
struct ThreeChannels {
  uint8_t pixel[3][3][kStrip];

  constexpr ThreeChannels() : pixel{} {
    for (int p = 0; p < 3; ++p)
      for (int c = 0; c < 3; ++c)
        for (int i = 0; i < kStrip; ++i) pixel[p][c][i] = (p * kStrip + i) % 3 == c ? (p * kStrip + i) / 3 : 0x80;
  }
};

inline void interleave_three(const uint8_t *planes, uint8_t *to) {
  alignas(16) static constexpr ThreeChannels kShown;
  const auto load_bytes = [](const uint8_t *p) { return _mm_loadu_si128(reinterpret_cast<const __m128i *>(p)); };
  for (int p = 0; p < 3; ++p) {
    __m128i out = _mm_setzero_si128();
    for (int c = 0; c < 3; ++c)
      out = _mm_or_si128(out, _mm_shuffle_epi8(load_bytes(planes + c * kStrip), load_bytes(kShown.pixel[p][c])));
    _mm_storeu_si128(reinterpret_cast<__m128i *>(to + p * kStrip), out);
  }
}
#endif

template <class T>
inline void write_row(const T *planes, int channels, int first, int last, T *to) {
#ifdef __SSSE3__
  if constexpr (sizeof(T) == 1) {
    if (channels == 3 && last - first == kStrip) return interleave_three(planes, to);
  }
#endif
  switch (channels) {
    case 1: interleave<1>(planes, 1, first, last, to); break;
    case 3: interleave<3>(planes, 3, first, last, to); break;
    case 4: interleave<4>(planes, 4, first, last, to); break;
    default: interleave<0>(planes, channels, first, last, to);
  }
}

// A row of one channel: `row` counts in the view, `from` holds the tile's values.
template <bool PLANES, class T>
inline void finish_row(const float *from, int channel, int64_t row, int left, const Background &b, const Samples &s,
                       T *to) {
  const float *line = b.taps ? b.lines + (channel * b.count + b.top[row]) * b.width : nullptr;
  const float *plane = PLANES ? b.planes + (channel * b.height + row) * b.plane_width : nullptr;
  for (int at = 0; at < kStrip; at += LANES) {
    Row values = load(from + at);
    for (int t = 0; t < b.taps; ++t)
      values += load_part(line + t * b.width, b.width, left + at) * b.down[row * b.taps + t];
    if (PLANES) values += load_part(plane, b.plane_width, left + at);
    if (s.clip) values = clipped(values, 1.0f) * s.span[channel] + s.low[channel];
    convert(values, to + at);
  }
}

template <bool PLANES, class T>
void finish_planes_as(const float *tile, int channels, const TileRect &r, const Background &b, const Samples &s) {
  T planes[kMostChannels * kStrip];
  for (int y = r.row0; y < r.row1; ++y) {
    const int64_t row = int64_t(r.y) + y;
    for (int strip = r.col0 / kStrip * kStrip; strip < r.col1; strip += kStrip) {
      for (int c = 0; c < channels; ++c)
        finish_row<PLANES>(tile + c * kTilePlane + y * kTileStride + strip, c, row, r.x + strip, b, s,
                           planes + c * kStrip);
      const int first = strip < r.col0 ? r.col0 - strip : 0, last = r.col1 - strip < kStrip ? r.col1 - strip : kStrip;
      T *to = static_cast<T *>(s.first) + row * s.row_stride + int64_t(r.x + strip + first) * channels;
      write_row(planes, channels, first, last, to);
    }
  }
}

template <class T>
void finish_as(const float *tile, int channels, const TileRect &r, const Background &b, const Samples &s) {
  b.planes ? finish_planes_as<true, T>(tile, channels, r, b, s) : finish_planes_as<false, T>(tile, channels, r, b, s);
}

void finish(const float *tile, int channels, const TileRect &rect, const Background &background,
            const Samples &samples) {
  switch (samples.type) {
    case SampleType::u8: finish_as<uint8_t>(tile, channels, rect, background, samples); break;
    case SampleType::u16: finish_as<uint16_t>(tile, channels, rect, background, samples); break;
    case SampleType::f32: finish_as<float>(tile, channels, rect, background, samples); break;
  }
}

}  // namespace

const FinishKernel FinishKernel::SGI_ISA{sgi::finish};

}  // namespace sgi
