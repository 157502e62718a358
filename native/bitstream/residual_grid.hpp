// The grids that samples of a residual layer lie on, and what they lack there (docs/format.md, "Residual layer").
#pragma once
#include <cstdint>
#include <vector>

#include "bitstream/bit_model.hpp"
#include "bitstream/bits.hpp"
#include "bitstream/header.hpp"

namespace sgi {

constexpr int32_t kMaxPalette = 1024;              // colours
constexpr int32_t kMaxGridSteps = (1 << 22) - 1;   // so that sums of errors in sixteenths fit in 32 bits
constexpr int32_t kMaxTableSteps = (1 << 16) - 1;  // of a grid with a table

// Values 0 ... `most` of a channel stand for samples base + step * value, or for those of a table.
struct ResidualGrid {
  double base, step;
  int32_t most;
  int32_t max_error;         // of values
  std::vector<float> table;  // samples that occur, rising; empty where there is no table
};

// Codes the table of a grid. Throws Error (corrupt) where bits tell of none.
template <class Bits>
void code_table(Bits &bits, bool is_float, ResidualGrid &grid);

// What a residual layer states of all its blocks.
struct ResidualForm {
  double max_error;           // of any sample
  bool has_bits;              // whether floats come back bit by bit, not only their values on the grid
  bool has_views;             // whether views at other scales and in other types are made from these samples
  bool has_cells;             // whether some cells of the picture alone are coded
  bool is_alpha;              // whether alpha alone is coded, for every view
  std::vector<int> channels;  // those that are coded, rising; all that follows is of these
  std::vector<ResidualGrid> grids;
  std::vector<int32_t>
      palette;  // [colours, channels] values of all that a pixel may be; empty where that is not stated

  int32_t colours() const { return int32_t(palette.size() / grids.size()); }
};

// What the rest of the stream draws in a block, on the grids.
struct GridBlock {
  std::vector<int32_t> values;
  // Which samples come out as they are drawn: nodata, floats that are not finite, and what is in no coded cell.
  std::vector<uint8_t> held;
};

// drawn [pixels, channels], in rows of `width`.
GridBlock on_grids(const Header &header, const ResidualForm &form, const float *drawn, int64_t width, size_t count);
// A sample of a value.
float sample_of(const ResidualGrid &grid, int32_t value);
// The values nearest to samples [count].
std::vector<int32_t> nearest_values(const ResidualForm &form, const float *samples, size_t count);

// Codes how many floats lie between some and what they were taken for.
class FloatDistances {
 public:
  // Throws Error (corrupt) where bits tell of no float.
  template <class Bits>
  void code(Bits &bits, float found, float &sample);

 private:
  static constexpr int kLengths = 34;  // of a distance, in bits

  int length_ = 0;  // of the last distance
  std::vector<BitModel> lengths_ = std::vector<BitModel>(size_t(kLengths) * kLengths);
};

// Turns values into samples, and codes what they do not say: where a value would be nodata, on which side of it the
// sample is; the bits of floats.
template <class Bits>
class GridRest {
 public:
  GridRest(const Header &header, const ResidualForm &form, Bits &bits);

  // Leaves in `samples` [count] what a reader finds. Throws Error (corrupt) where bits tell of no float.
  void code(const GridBlock &drawn, const std::vector<int32_t> &values, const float *shown, float *samples);

 private:
  // What is known of a channel.
  struct Channel {
    int32_t nodata = -1;  // the value that would stand for it, if any may be off
    FloatDistances distances;
  };

  int32_t beside_nodata(const Channel &channel, const ResidualGrid &grid, float sample);

  const Header &header_;
  const ResidualForm &form_;
  Bits &bits_;
  std::vector<Channel> channels_;
};

extern template void code_table(RangeEncoder &bits, bool is_float, ResidualGrid &grid);
extern template void code_table(RangeDecoder &bits, bool is_float, ResidualGrid &grid);
extern template class GridRest<RangeEncoder>;
extern template class GridRest<RangeDecoder>;

}  // namespace sgi
