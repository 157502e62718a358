// An opened stream: any region at any scale.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "bitstream/stream_reader.hpp"
#include "bitstream/tile.hpp"
#include "decoder/exact_blocks.hpp"
#include "decoder/samples.hpp"
#include "decoder/tile_cache.hpp"
#include "decoder/view.hpp"

namespace sgi {

// What all tiles hold together.
struct Survey {
  int64_t seeds = 0;
  std::array<double, kParts> part_bytes{};
  int64_t mask_bytes = 0;
  uint32_t symbol_crc = 0;
  int64_t texture_cells[3] = {};  // of sides 8, 16, 32
};

// How a view is drawn.
struct DrawOptions {
  bool exact = false;   // never from the overview
  bool dither = false;  // samples of eight bits where the source had more
  bool lossy = false;   // without the residual layer
};

// Several threads may use one at once; they take turns. What fails throws Error, or what the source throws.
class Stream {
 public:
  // An overview in an overview is passed over: `is_overview`.
  Stream(std::unique_ptr<ByteSource> source, const DecoderSettings &settings, bool is_overview = false);

  const StreamReader &chunks() const { return chunks_; }
  const Header &header() const { return chunks_.header(); }
  std::vector<uint8_t> tile(int64_t number);  // the payload of its chunk

  // What pixels outside the picture hold, in samples of the source: at first nodata if the header has it, else 0.
  void set_blank(double sample);
  // Decodes the tiles of a view, as many as half of the cache holds: so those that are not sound are found before
  // memory is taken for what is rendered.
  void prepare(const PictureView &view, bool exact);
  // Fills out [rows, columns, C], rows `stride` bytes apart, with rows top ... top + rows - 1 of a view. A residual
  // layer changes views in the picture's own pixels and type.
  void draw(const PictureView &view, int64_t top, int64_t rows, Output output, const DrawOptions &options, void *out,
            int64_t stride);
  // Decodes all tiles, or those that are not known yet.
  const Survey &survey();
  // By how much samples are off the source's at most where the residual layer is drawn; -1 where there is none, or one
  // of some cells alone.
  double max_error();
  // Checks the CRC of the residual layer's chunk, if there is one, which no view does. Throws Error for a wrong one.
  void check_residual();
  // The same, and decodes all of the layer. Throws Error for one that is not sound.
  void check_exact();
  // Whether views at any scale and in any type show what the residual layer makes exact.
  bool has_exact_views();
  // Whether that is alpha alone.
  bool has_exact_alpha();
  // The same of samples of text and line art, where the layer is of their cells alone; else -1.
  double graphics_error();
  // Channels that the residual layer has, where it does not have all, from 0 on.
  std::vector<int> exact_bands();
  bool has_overview() const { return chunks_.has_overview(); }
  Stream &overview();  // throws Error (usage) where there is none
  // Of the one that was asked for, else empty.
  const std::vector<uint8_t> &overview_bytes() const { return overview_bytes_; }

  // A decoded tile; good until another one is asked for or rendered. Throws Error: corrupt, limit, region.
  const TileRenderer &renderer(int64_t number);

  struct Tiles {
    int64_t held;     // that are kept now
    int64_t decoded;  // so far, to be rendered
    int64_t ahead;    // of these by threads of their own
  };
  Tiles tiles();

 private:
  void draw_inside(const PictureView &view, int64_t top, const PixelBlock &block, Output output,
                   const DrawOptions &options);
  ExactBlocks *exact_blocks();  // null without residual layer

  const DecoderSettings settings_;
  StreamReader chunks_;
  TileCache tiles_;
  std::optional<double> nodata_;
  std::unique_ptr<ExactBlocks> exact_blocks_;
  std::optional<Survey> survey_;
  std::vector<uint8_t> overview_bytes_;
  std::unique_ptr<Stream> overview_;
  std::recursive_mutex turn_;
};

}  // namespace sgi
