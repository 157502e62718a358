// Restoration of drawn pixels by a network (docs/format.md, "Restoration").
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "base/isa.hpp"
#include "model/restoration_network.hpp"
#include "model/texture_axis.hpp"

namespace sgi {

// Pixels of a tile.
struct TileBlock {
  int64_t left, top, columns, rows;
};

// Samples of pixels of a tile: channel c of the one at (x, y) of the block is at x * pixel + y * row + c * channel.
template <class T>
struct TilePixels {
  T *first;
  TileBlock block;
  int64_t pixel, row, channel;

  // Those of a place in the tile.
  T *at(int64_t x, int64_t y) const { return first + (x - block.left) * pixel + (y - block.top) * row; }
};

// The same pixel by pixel, or plane by plane.
template <class T>
TilePixels<T> interleaved(T *first, const TileBlock &block, int64_t channels) {
  return {first, block, channels, channels * block.columns, 1};
}
template <class T>
TilePixels<T> in_planes(T *first, const TileBlock &block) {
  return {first, block, 1, block.columns, block.columns * block.rows};
}

// Takes values [columns, C] of pixels side by side, from the one at (x, y) of the tile on.
using RowSink = std::function<void(int64_t x, int64_t y, int64_t columns, const float *values)>;

// What a tile states.
struct RestorationChoice {
  int network = 0;  // number of a shipped one; 0: none
  int step = 0;     // index of the step in whose units it sees pixels
};

// Restores a tile of `width` times `height` pixels of C channels. Safe for use by several threads at once.
class Restoration {
 public:
  // mix [3, 3], as `texture_mix` gives it; empty for fewer than three channels.
  Restoration(std::shared_ptr<const RestorationNetwork> network, int step, int channels, const std::vector<float> &mix,
              int64_t width, int64_t height, Isa isa);

  // What must be drawn of the tile for what these axes show of it, at scales of 1 and above.
  TileBlock needed(const OutputAxis &x, const OutputAxis &y) const;
  // The same values for any block that is asked for, number of threads and instruction set:
  // Adds the correction to values [y.count, x.count, C] of what the axes show. drawn: the needed block, [rows, columns,
  // C].
  void add(const float *drawn, const OutputAxis &x, const OutputAxis &y, int threads, float *values) const;
  // Adds the correction of a block of the tile's own pixels to it. drawn: the block and what is around it.
  void correct(const TilePixels<const float> &drawn, int threads, const TilePixels<float> &values) const;
  // Hands out a block of the tile's own pixels, restored, row by row of strips of it, on several threads. drawn: the
  // block and what is around it [rows, columns, C].
  void restore(const TilePixels<const float> &drawn, const TileBlock &block, int threads, const RowSink &sink) const;

 private:
  TileBlock shown(const OutputAxis &x, const OutputAxis &y) const;
  int64_t strip_columns() const;
  using StripSink = std::function<void(const TileBlock &strip, const int32_t *sums)>;
  void run_strips(const TilePixels<const float> &drawn, const TileBlock &block, int threads,
                  const StripSink &sink) const;
  void add_row(const TileBlock &strip, int64_t row, const int32_t *sums, const RestorationMix &mix,
               float *values) const;
  const int32_t *run(const TilePixels<const float> &drawn, const TileBlock &strip) const;
  void read_inputs(const TilePixels<const float> &drawn, const TileBlock &strip, int64_t rows, int32_t *inputs) const;

  const std::shared_ptr<const RestorationNetwork> network_;
  const int channels_, mixed_;     // how many of them the network sees
  std::vector<float> into_, out_;  // [mixed, mixed], with the units of inputs and sums
  const int64_t width_, height_;
  const Isa isa_;
};

}  // namespace sgi
