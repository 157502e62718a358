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

// Channels of a block of a tile, plane by plane.
template <class T>
struct TilePlanes {
  T *first;
  TileBlock block;

  int64_t size() const { return block.columns * block.rows; }  // of a plane
  // A channel at a place in the tile.
  T *at(int64_t channel, int64_t x, int64_t y) const {
    return first + channel * size() + (y - block.top) * block.columns + (x - block.left);
  }
};

// Takes rows of the channels of pixels side by side, from the one at (x, y) of the tile on.
using RowSink = std::function<void(int64_t x, int64_t y, int64_t columns, const float *const *channels)>;

// What a tile states.
struct RestorationChoice {
  int network = 0;  // number of a shipped one; 0: none
  int step = 0;     // index of the step in whose units it sees pixels
};

// Restores a tile of `width` times `height` pixels of C channels. Safe for use by several threads at once.
class Restoration {
 public:
  Restoration(std::shared_ptr<const RestorationNetwork> network, int step, int channels, int64_t width, int64_t height,
              Isa isa);

  // Columns of blocks that are restored one after the other: whole strips, and few of them, so that as little as may be
  // is drawn twice around a block.
  int64_t block_columns(int64_t columns) const;

  // What must be drawn of the tile for what these axes show of it, at scales of 1 and above.
  TileBlock needed(const OutputAxis &x, const OutputAxis &y) const;
  // The same values for any block that is asked for, number of threads and instruction set; drawn: the needed block, or
  // the block that is asked for and what is around it.
  // Adds the correction to planes [C, y.count, x.count] of what the axes show.
  void add(const TilePlanes<const float> &drawn, const OutputAxis &x, const OutputAxis &y, int threads,
           float *planes) const;
  // Writes the correction of a block of the tile's own pixels; channels that are not corrected stay as they are.
  void correct(const TilePlanes<const float> &drawn, int threads, const TilePlanes<float> &correction) const;
  // Hands out a block of the tile's own pixels, restored, row by row of strips of it, on several threads.
  void restore(const TilePlanes<const float> &drawn, const TileBlock &block, int threads, const RowSink &sink) const;

 private:
  TileBlock shown(const OutputAxis &x, const OutputAxis &y) const;
  int64_t strip_columns() const;
  using StripSink = std::function<void(const TileBlock &strip, const int32_t *sums)>;
  void run_strips(const TilePlanes<const float> &drawn, const TileBlock &block, int threads,
                  const StripSink &sink) const;
  const int32_t *run(const TilePlanes<const float> &drawn, const TileBlock &strip) const;
  void read_inputs(const TilePlanes<const float> &drawn, const TileBlock &strip, int64_t rows, int32_t *inputs) const;

  const std::shared_ptr<const RestorationNetwork> network_;
  const int channels_, seen_;  // of the tile, and how many of them the network sees and corrects
  const float into_, out_;     // the units of inputs and of sums
  const int64_t width_, height_;
  const Isa isa_;
};

}  // namespace sgi
