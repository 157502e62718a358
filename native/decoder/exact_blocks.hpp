// The blocks of a residual layer, decoded as they are needed, over what the rest of the stream draws.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "bitstream/residual_layer.hpp"
#include "bitstream/stream_reader.hpp"
#include "decoder/samples.hpp"
#include "decoder/tile_renderer.hpp"

namespace sgi {

// Those used last are kept, in as many bytes as tiles are, and at least those of one row of a view. Not safe for use by
// two threads at once.
class ExactBlocks {
 public:
  // A region of the picture.
  struct Place {
    int64_t x, y, width, height;
  };
  // Draws a region into samples [height, width, channels] of the source's type without the layer.
  using Draw = std::function<void(const Place &, const PixelBlock &)>;

  // Throws Error (corrupt).
  ExactBlocks(StreamReader &chunks, const DecoderSettings &settings);

  double max_error() const { return table_.form.max_error; }
  // Whether views at other scales and in other types are made from these samples.
  bool has_views() const { return table_.form.has_views; }
  // Whether views are made of them in some cells alone, and are drawn elsewhere.
  bool has_cells() const { return table_.form.has_cells; }
  // Whether alpha of every view is made of these samples, and nothing else.
  bool is_alpha() const { return table_.form.is_alpha; }
  // The channels that come from the layer, from 0 on.
  const std::vector<int> &channels() const { return table_.form.channels; }
  bool has_all_channels() const { return int(channels().size()) == chunks_.header().spec.channels; }
  // Whether any sample of the block that holds a pixel comes from the layer.
  bool is_coded(int64_t x, int64_t y) const { return table_.blocks[size_t(number(x, y))].bytes > 0; }
  // Whether samples of each cell of the block that holds a pixel come from the layer: as in ResidualSamples, until the
  // next call. Throws Error (corrupt).
  const std::vector<uint8_t> &cells(int64_t x, int64_t y, const Draw &draw);
  // The block that holds a pixel.
  Place around(int64_t x, int64_t y) const { return place(number(x, y)); }
  // Fills samples of a type, the source's or floats, with the region whose first pixel is (x, y), but for
  // channels that the layer does not have. Throws Error (corrupt).
  void fill(int64_t x, int64_t y, const PixelBlock &out, SampleType type, const Draw &draw);

 private:
  struct Kept {
    ResidualSamples found;
    int64_t use;  // when it was used last
  };

  int64_t number(int64_t x, int64_t y) const { return y / kResidualBlock * across_ + x / kResidualBlock; }
  Place place(int64_t number) const;
  void decode(const std::vector<int64_t> &numbers, const Draw &draw);
  std::vector<float> drawn(const Place &place, const Draw &draw) const;
  void copy(int64_t number, int64_t x, int64_t y, const PixelBlock &out, SampleType type) const;
  void forget();

  StreamReader &chunks_;
  const DecoderSettings settings_;
  const int64_t across_;  // blocks of a row
  const ResidualTable table_;
  std::map<int64_t, Kept> blocks_;
  int64_t bytes_ = 0, uses_ = 0;
};

}  // namespace sgi
