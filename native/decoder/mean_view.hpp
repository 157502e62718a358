// Views at any scale of samples that are known exactly: each pixel is the mean of what it covers.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "bitstream/header.hpp"
#include "decoder/samples.hpp"
#include "decoder/view.hpp"

namespace sgi {

// Draws rows of a view inside the picture into blocks of a format.
class MeanView {
 public:
  // Fills samples [rows, columns, C] with the region of the picture whose first pixel is (x, y).
  using Fill = std::function<void(int64_t x, int64_t y, int64_t columns, int64_t rows, float *samples)>;

  // channels: those that are filled in and drawn; others are anything. is_alpha: that is alpha alone; pixels that show
  // less than one of the picture are means over as much, so that enlarged ones have no edges.
  MeanView(const Header &header, const PictureView &view, const Fill &fill, int threads,
           const std::vector<int> &channels, bool is_alpha);

  // Columns left ... left + block.columns - 1 of rows top ... top + block.rows - 1.
  void draw(int64_t left, int64_t top, const PixelBlock &block, const SampleFormat &format, bool dither) const;

 private:
  // What an output pixel covers along an axis: pixels from `first` on, with the weights of the first, of those
  // between, which is 1, and of the last.
  struct Cover {
    int64_t first, last;
    double low, high;

    double weight(int64_t at) const;
  };

  Cover cover(double start, double scale, int64_t index, int64_t size) const;
  // Samples of the picture, from a column and a row on.
  struct Source {
    int64_t left, top, width;
    std::vector<float> samples;
  };
  // The values [columns, C] of an output row from output column `left` on.
  void average(int64_t row, int64_t left, int64_t columns, const Source &source, float *values) const;

  const Header &header_;
  const PictureView &view_;
  const Fill &fill_;
  const int threads_;
  const std::vector<int> &channels_;
  const bool is_alpha_;
  std::vector<Cover> columns_;
};

}  // namespace sgi
