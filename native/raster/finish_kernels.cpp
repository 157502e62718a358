// Finishing in vectors of LANES pixels.
#ifdef __SSSE3__
#include <immintrin.h>
#endif

#include "base/vector.hpp"
#include "raster/finish_kernel.hpp"
#include "raster/sample_values.hpp"

namespace sgi {
namespace {

using Words = uint16_t __attribute__((vector_size(LANES * 2)));
using Bytes = uint8_t __attribute__((vector_size(LANES)));

constexpr int kStrip = 16;  // columns that are interleaved at once

// The values of a line from column x on, all of them there if INSIDE; zeros where there is none.
template <bool INSIDE>
inline vf load_part(const float *line, int64_t width, int64_t x) {
  if (INSIDE || (x >= 0 && x + LANES <= width)) return load(line + x);
  vf row{};
  for (int i = 0; i < LANES; ++i)
    if (x + i >= 0 && x + i < width) row[i] = line[x + i];
  return row;
}

inline vi integers(vf row, float most) { return __builtin_convertvector(rounded(row, most), vi); }

inline void convert(vf row, uint8_t *to) {
  const Bytes samples = __builtin_convertvector(integers(row, 255.0f), Bytes);
  __builtin_memcpy(to, &samples, sizeof samples);
}

inline void convert(vf row, uint16_t *to) {
  const Words samples = __builtin_convertvector(integers(row, 65535.0f), Words);
  __builtin_memcpy(to, &samples, sizeof samples);
}

inline void convert(vf row, float *to) { __builtin_memcpy(to, &row, sizeof row); }

template <int C, class T>
inline void interleave(const T *planes, int channels, int first, int last, T *to) {
  const int count = C ? C : channels;
  for (int x = first; x < last; ++x)
    for (int c = 0; c < count; ++c) *to++ = planes[c * kTileWidth + x];
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
      out = _mm_or_si128(out, _mm_shuffle_epi8(load_bytes(planes + c * kTileWidth), load_bytes(kShown.pixel[p][c])));
    _mm_storeu_si128(reinterpret_cast<__m128i *>(to + p * kStrip), out);
  }
}
#endif

template <class T>
inline void write_row(const T *planes, int channels, int first, int last, T *to) {
#ifdef __SSSE3__
  if constexpr (sizeof(T) == 1) {
    if (channels == 3 && last - first == kStrip) return interleave_three(planes + first, to);
  }
#endif
  switch (channels) {
    case 1: interleave<1>(planes, 1, first, last, to); break;
    case 3: interleave<3>(planes, 3, first, last, to); break;
    case 4: interleave<4>(planes, 4, first, last, to); break;
    default: interleave<0>(planes, channels, first, last, to);
  }
}

// A row of one channel, strip after strip: `row` counts in the view, `from` holds the tile's values. TAPS: their
// number, or 0 for what the background says.
template <bool PLANES, bool INSIDE, int TAPS, class T>
inline void finish_row(const float *from, int channel, int64_t row, const TileRect &r, const Background &b,
                       const Samples &s, T *to) {
  const int taps = TAPS ? TAPS : b.taps;
  const float *line = taps ? b.lines + (channel * b.count + b.top[row]) * b.width : nullptr;
  const float *plane = PLANES ? b.planes + (channel * b.height + row) * b.plane_width : nullptr;
  const float *down = taps ? b.down + row * taps : nullptr;
  const float span = s.clip ? s.span[channel] : 1.0f, low = s.clip ? s.low[channel] : 0.0f;
  for (int at = r.col0 / kStrip * kStrip; at < r.col1; at += LANES) {
    vf values = load(from + at);
    for (int t = 0; t < taps; ++t) values += load_part<INSIDE>(line + t * b.width, b.width, r.x + at) * down[t];
    if (PLANES) values += load_part<false>(plane, b.plane_width, r.x + at);
    if (s.clip) values = mapped(values, low, span);
    convert(values, to + at);
  }
}

template <bool PLANES, bool INSIDE, int TAPS, class T>
void finish_rows(const float *tile, int channels, const TileRect &r, const Background &b, const Samples &s) {
  T planes[kMaxDrawnChannels * kTileWidth];
  for (int y = r.row0; y < r.row1; ++y) {
    const int64_t row = int64_t(r.y) + y;
    for (int c = 0; c < channels; ++c)
      finish_row<PLANES, INSIDE, TAPS>(tile + c * kTilePlane + y * kTileStride, c, row, r, b, s,
                                       planes + c * kTileWidth);
    T *to = static_cast<T *>(s.first) + row * s.row_stride + int64_t(r.x) * channels;
    for (int strip = r.col0 / kStrip * kStrip; strip < r.col1; strip += kStrip) {
      const int first = strip < r.col0 ? r.col0 : strip, last = r.col1 - strip < kStrip ? r.col1 : strip + kStrip;
      write_row(planes, channels, first, last, to + first * channels);
    }
  }
}

template <bool PLANES, class T>
void finish_planes_as(const float *tile, int channels, const TileRect &r, const Background &b, const Samples &s) {
  const bool inside = r.x >= 0 && r.x + kTileWidth <= b.width;
  if (inside && b.taps == 4)
    finish_rows<PLANES, true, 4, T>(tile, channels, r, b, s);
  else
    finish_rows<PLANES, false, 0, T>(tile, channels, r, b, s);
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

inline bool all_equal(const float *values, int count) {
  for (int i = 1; i < count; ++i)
    if (values[i] != values[0]) return false;
  return true;
}

// Where all channels have one range.
template <class T>
void store_alike(const float *values, int64_t count, const Samples &s, T *to) {
  const float low = s.low[0], span = s.span[0];
  const auto sample = [&](vf row) { return s.clip ? mapped(row, low, span) : row; };
  int64_t i = 0;
  for (; i + LANES <= count; i += LANES) convert(sample(load(values + i)), to + i);
  if (i == count) return;
  vf row{};
  T samples[LANES];
  __builtin_memcpy(&row, values + i, (count - i) * sizeof *values);
  convert(sample(row), samples);
  __builtin_memcpy(to + i, samples, (count - i) * sizeof *samples);
}

template <class T>
void store_apart(const float *values, int64_t pixels, int channels, const Samples &s, T *to) {
  for (int64_t i = 0; i < pixels; ++i)
    for (int c = 0; c < channels; ++c, ++values, ++to) *to = stored<T>(mapped(*values, s.low[c], s.span[c]));
}

template <class T>
void store_as(const float *values, int64_t pixels, int channels, const Samples &s) {
  T *to = static_cast<T *>(s.first);
  if (!s.clip || (all_equal(s.low, channels) && all_equal(s.span, channels)))
    store_alike(values, pixels * channels, s, to);
  else
    store_apart(values, pixels, channels, s, to);
}

void store(const float *values, int64_t pixels, int channels, const Samples &samples) {
  switch (samples.type) {
    case SampleType::u8: store_as<uint8_t>(values, pixels, channels, samples); break;
    case SampleType::u16: store_as<uint16_t>(values, pixels, channels, samples); break;
    case SampleType::f32: store_as<float>(values, pixels, channels, samples); break;
  }
}

}  // namespace

const FinishKernel FinishKernel::SGI_ISA{sgi::finish, sgi::store};

}  // namespace sgi
