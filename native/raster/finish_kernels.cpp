// Finishing in vectors of LANES pixels.
#ifdef SGI_X86
#include <immintrin.h>
#endif

#include "base/vector.hpp"
#include "raster/finish_kernel.hpp"
#include "raster/sample_values.hpp"

namespace sgi {
namespace {

using Words = uint16_t __attribute__((vector_size(LANES * 2)));
using Bytes = uint8_t __attribute__((vector_size(LANES)));

constexpr int kStrip = 16;  // pixels that are interleaved at once

// Of values of which there are so many; zeros behind.
inline vf load_part(const float *values, int64_t count) {
  if (count >= LANES) return load(values);
  vf row{};
  __builtin_memcpy(&row, values, size_t(count) * sizeof *values);
  return row;
}

// What samples of type T stand for, within its range: a range that is mapped to is.
template <class T>
inline vf ranged(vf row, const Samples &s, int channel) {
  if (s.clip) return mapped(row, s.low[channel], s.span[channel]);
  return kIsFloat<T> ? row : clipped(row, float(T(-1)));
}

inline vi integers(vf row) { return __builtin_convertvector(rounded(row), vi); }

// Without instructions of AVX-512, g++ would take vectors apart one by one.
inline void convert(vf row, uint8_t *to) {
  const vi values = integers(row);
#if defined(SGI_X86) && LANES < 16
#if LANES == 8
  const auto low = _mm256_castsi256_si128((__m256i)values), high = _mm256_extracti128_si256((__m256i)values, 1);
  const __m128i words = _mm_packs_epi32(low, high);
#else
  const __m128i words = _mm_packs_epi32((__m128i)values, (__m128i)values);
#endif
  const __m128i samples = _mm_packus_epi16(words, words);
#else
  const Bytes samples = __builtin_convertvector(values, Bytes);
#endif
  __builtin_memcpy(to, &samples, LANES);
}

inline void convert(vf row, uint16_t *to) {
  const Words samples = __builtin_convertvector(integers(row), Words);
  __builtin_memcpy(to, &samples, sizeof samples);
}

inline void convert(vf row, float *to) { __builtin_memcpy(to, &row, sizeof row); }

template <int C, class T>
inline void interleave(const T *planes, int channels, int count, T *to) {
  const int each = C ? C : channels;
  for (int x = 0; x < count; ++x)
    for (int c = 0; c < each; ++c) *to++ = planes[c * kStrip + x];
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

// Of a strip of so many pixels; planes: kStrip samples of each channel.
template <class T>
inline void write_strip(const T *planes, int channels, int count, T *to) {
#ifdef __SSSE3__
  if constexpr (sizeof(T) == 1) {
    if (channels == 3 && count == kStrip) return interleave_three(planes, to);
  }
#endif
  switch (channels) {
    case 1: interleave<1>(planes, 1, count, to); break;
    case 3: interleave<3>(planes, 3, count, to); break;
    case 4: interleave<4>(planes, 4, count, to); break;
    default: interleave<0>(planes, channels, count, to);
  }
}

template <class T>
void store_channels_as(const float *const *rows, int64_t pixels, int channels, const Samples &s) {
  T planes[kMaxDrawnChannels * kStrip];
  T *to = static_cast<T *>(s.first);
  for (int64_t at = 0; at < pixels; at += kStrip) {
    const int count = int(pixels - at < kStrip ? pixels - at : kStrip);
    for (int x = 0; x < count; x += LANES) {
      const auto channel = [&](int c) { return load_part(rows[c] + at + x, pixels - at - x); };
      const auto write = [&](int c, vf row) { convert(ranged<T>(row, s, c), planes + c * kStrip + x); };
      int c = 0;
      if (s.mix) {
        const vf first = channel(0), second = channel(1), third = channel(2);
        for (; c < 3; ++c) write(c, s.mix[3 * c] * first + s.mix[3 * c + 1] * second + s.mix[3 * c + 2] * third);
      }
      for (; c < channels; ++c) write(c, channel(c));
    }
    write_strip(planes, channels, count, to + at * channels);
  }
}

void store_channels(const float *const *rows, int64_t pixels, int channels, const Samples &samples) {
  switch (samples.type) {
    case SampleType::u8: store_channels_as<uint8_t>(rows, pixels, channels, samples); break;
    case SampleType::u16: store_channels_as<uint16_t>(rows, pixels, channels, samples); break;
    case SampleType::f32: store_channels_as<float>(rows, pixels, channels, samples); break;
  }
}

// Writes the first `count` values of a vector.
inline void store_part(float *to, int count, vf values) {
  if (count >= LANES) return store(to, values);
  __builtin_memcpy(to, &values, size_t(count) * sizeof *to);
}

// The pixels of a row of one channel of a tile that lie in the view, on their background. TAPS: their number, or 0 for
// what the background says.
template <bool PLANES, bool INSIDE, int TAPS>
inline void finish_row(const float *tile, int channel, int y, const TileRect &r, const Background &b, float *to) {
  const int taps = TAPS ? TAPS : b.taps;
  const int64_t row = int64_t(r.y) + y;
  const float *from = tile + channel * kTilePlane + y * kTileStride;
  const float *line = taps ? b.lines + (channel * b.count + b.top[row]) * b.width + r.x : nullptr;
  const float *plane = PLANES ? b.planes + channel * b.plane + y * b.plane_row : nullptr;
  const float *down = taps ? b.down + row * taps : nullptr;
  for (int at = r.col0; at < r.col1; at += LANES) {
    vf values = load(from + at);
    for (int t = 0; t < taps; ++t) {
      const float *const tap = line + t * b.width + at;
      values += (INSIDE ? load(tap) : load_part(tap, b.width - r.x - at)) * down[t];
    }
    if (PLANES) values += load(plane + at);
    store_part(to + at - r.col0, r.col1 - at, values);
  }
}

// Hands out the rows of a tile: sink(y, write), in which write(c, to) writes channel c.
template <bool PLANES, bool INSIDE, int TAPS, class Sink>
inline void finish_rows(const float *tile, const TileRect &r, const Background &b, Sink sink) {
  for (int y = r.row0; y < r.row1; ++y)
    sink(y, [&](int c, float *to) { finish_row<PLANES, INSIDE, TAPS>(tile, c, y, r, b, to); });
}

template <bool PLANES, class Sink>
inline void finish_planes(const float *tile, const TileRect &r, const Background &b, Sink sink) {
  const bool inside = r.x + r.col0 + kTileWidth <= b.width;
  if (inside && b.taps == 4)
    finish_rows<PLANES, true, 4>(tile, r, b, sink);
  else
    finish_rows<PLANES, false, 0>(tile, r, b, sink);
}

template <class Sink>
inline void finish_on(const float *tile, const TileRect &r, const Background &b, Sink sink) {
  b.planes ? finish_planes<true>(tile, r, b, sink) : finish_planes<false>(tile, r, b, sink);
}

void finish(const float *tile, int channels, const TileRect &r, const Background &background, const Samples &samples) {
  Samples row_samples = samples;
  float values[kMaxDrawnChannels * kTileWidth];
  const float *rows[kMaxDrawnChannels];
  for (int c = 0; c < channels; ++c) rows[c] = values + c * kTileWidth;
  finish_on(tile, r, background, [&](int y, auto write) {
    for (int c = 0; c < channels; ++c) write(c, values + c * kTileWidth);
    const int64_t first = (int64_t(r.y) + y) * samples.row_stride + int64_t(r.x + r.col0) * channels;
    row_samples.first = static_cast<uint8_t *>(samples.first) + first * bytes_of(samples.type);
    store_channels(rows, r.col1 - r.col0, channels, row_samples);
  });
}

void finish_channels(const float *tile, int channels, const TileRect &r, const Background &background,
                     const ChannelPlanes &planes) {
  finish_on(tile, r, background, [&](int y, auto write) {
    float *to = planes.first + (int64_t(r.y) + y) * planes.row_stride + r.x + r.col0;
    for (int c = 0; c < channels; ++c, to += planes.plane) write(c, to);
  });
}

inline bool all_equal(const float *values, int count) {
  for (int i = 1; i < count; ++i)
    if (values[i] != values[0]) return false;
  return true;
}

// Where all channels have one range.
template <class T>
void store_alike(const float *values, int64_t count, const Samples &s, T *to) {
  int64_t i = 0;
  for (; i + LANES <= count; i += LANES) convert(ranged<T>(load(values + i), s, 0), to + i);
  if (i == count) return;
  vf row{};
  T samples[LANES];
  __builtin_memcpy(&row, values + i, (count - i) * sizeof *values);
  convert(ranged<T>(row, s, 0), samples);
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

const FinishKernel FinishKernel::SGI_ISA{sgi::finish, sgi::finish_channels, sgi::store_channels, sgi::store};

}  // namespace sgi
