// How a picture's values become samples of a type: range, nodata, dither.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "base/isa.hpp"
#include "bitstream/header.hpp"
#include "raster/finish_kernel.hpp"

namespace sgi {

// How samples are stored: as samples of a type, or as floats, nominally 0 ... 1 and not clipped.
using Output = std::optional<SampleType>;
constexpr Output kValues{};

// Output pixels [rows, columns, C] that somebody else holds; rows are `stride` samples apart.
struct PixelBlock {
  void *first;
  int64_t columns, rows, stride;
};

// What is stored where: values as they are, or samples low + span * value, in the ranges of the source. In another type
// than the source's the range is that of the type; nodata becomes the value next to it.
class SampleFormat {
 public:
  // nodata: what stands for nothing in the source, if anything does; isa: of what stores values.
  SampleFormat(const Header &header, Output output, std::optional<double> nodata, Isa isa = Isa::portable);

  bool is_mapped() const { return is_mapped_; }
  bool is_dithered(SampleType source) const { return is_mapped_ && type == SampleType::u8 && source != type; }
  int64_t sample_bytes() const { return bytes_of(type); }
  // The part of a block from a column and a row on.
  PixelBlock part(const PixelBlock &block, int64_t left, int64_t top, int64_t columns, int64_t rows) const;
  // For the rasteriser: samples of this format in a block.
  Samples samples(const PixelBlock &block) const;
  // Stores pixels side by side from rows of their channels, from the first of a block on.
  void store_channels(const float *const *rows, const PixelBlock &block) const;

  // Stores values [rows, columns, C], which are mixed already.
  void store(const float *values, const PixelBlock &block, int threads) const;
  // Stores them so that the mean of a few pixels is the value: each is rounded up or down. The block begins at output
  // pixel (x, y), alone with the channel the threshold follows from, so that bands and threads do not show.
  void store_dithered(const float *values, int64_t x, int64_t y, const PixelBlock &block, int threads) const;
  // Stores a sample in all of a block.
  void fill(double sample, const PixelBlock &block) const;
  // Stores alpha 0 in pixels of a row that are `empty`.
  void mark_transparent(const uint8_t *empty, const PixelBlock &row) const;
  // Stores nodata in the colours `first` ... `last` - 1 of pixels of a row that are `empty`; where others have its
  // value, they go one step aside.
  void mark_nodata(const uint8_t *empty, const PixelBlock &row, int first, int last) const;
  // Stores a sample of the source in a channel of all of a block; in another type it does not become nodata.
  void state(double sample, int channel, const PixelBlock &block) const;

  const SampleType type;
  const int channels, alpha;
  const double blank;  // of a pixel outside the picture
  const Isa isa;

 private:
  template <class T>
  T beside_nodata(int channel) const;

  bool is_mapped_, is_source_, has_nodata_;      // is_source_: whether samples are of the source's type
  std::vector<double> from_, to_;                // [C] the range that is stored
  std::vector<double> source_from_, source_to_;  // [C] the source's
  double nodata_;
  std::vector<float> low_, span_;  // [C]
  std::vector<float> mix_;         // as of `sample_mix`
};

}  // namespace sgi
