// One tile's decoded model, which draws any part of itself at any scale.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/kept_floats.hpp"
#include "bitstream/tile.hpp"
#include "decoder/arriving_texture.hpp"
#include "decoder/samples.hpp"
#include "decoder/view.hpp"
#include "model/restoration.hpp"
#include "raster/rescaling.hpp"

namespace sgi {

struct DecoderSettings {
  int threads = 0;  // 0: one for each core
  Isa isa = Isa::portable;
  int64_t cache_bytes = int64_t(1) << 28;    // what decoded tiles may take before those used least recently go
  int64_t block_samples = int64_t(1) << 27;  // rendered at a time, at most; less where it restores
  std::function<void()> between = nullptr;   // called between tiles by who draws them; what it throws ends the call
  bool checked = true;                       // as of `read_tile`
  int64_t tile_memory = kAnyMemory;          // as of `read_tile`
};

// What is known of a decoded tile besides what it draws.
struct TileFacts {
  int64_t seeds = 0;
  int64_t mask_bytes = 0;  // of its number, masks and exact samples
  TileEnd end;
  int64_t texture_cells[3] = {};  // of sides 8, 16, 32
};

// Reads the payload of a chunk T, on other threads than the settings say. Texture may come last, while the tile is
// drawn: what needs it waits for it, and throws what was wrong with it. Throws Error: corrupt, limit. The settings must
// outlive it. Not safe for use by two threads at once.
class TileRenderer {
 public:
  TileRenderer(const Header &header, std::vector<uint8_t> payload, int threads, const DecoderSettings &settings);

  // Waits until all of it is read.
  void complete();
  // Does what `draw` would have to do first.
  void prepare(const PictureView &view, int threads);
  // Draws output pixels from (x, y) of the view on.
  void draw(const PictureView &view, int64_t x, int64_t y, const PixelBlock &block, const SampleFormat &format,
            int threads);

  TileFacts facts();
  bool is_empty() const { return is_empty_; }
  // Which of its pixels hold nothing: one mask for all bands, one for each colour, or none where all hold something.
  const std::vector<BandMask> &masks() const { return masks_; }
  // Samples that are stated exactly, by ascending place.
  const std::vector<ExactSample> &exact() const { return exact_; }
  const PixelRect &place() const { return place_; }  // in the picture
  int64_t memory() const;                            // bytes, about
  // Those that it sums, in its own pixels.
  const GaussianSet &gaussians() const { return gaussians_; }

 private:
  // The tile as a reduced view shows it [rows, columns, C], and where that is in the view.
  struct Whole {
    PictureView view;
    int64_t left, top, columns, rows;
    std::vector<float> samples;
  };
  // Gaussians of a scale. Their pixels count from the output pixel (left, top) and the offset of the view's axes.
  struct Rescaled {
    double sx, sy, x, y;  // output pixels of the tile where theirs begin
    int64_t left, top;
    GaussianSet gaussians;
  };

  // What all blocks of a view are rendered with.
  struct Tools {
    Rasterizer raster;
    const GaussianSet &gaussians;
    int64_t left, top;  // output pixel of the tile from which their pixels count
  };

  // The same where it is restored.
  struct Restored {
    Tools own, shown;  // of its own pixels, and of the view
    KeptFloats drawn = {}, planes = {};
  };

  void take(const TileModel &model, int threads);
  const Whole *whole(const PictureView &view, int threads);
  void draw_blocks(const PictureView &view, int64_t x, int64_t y, const PixelBlock &block, const SampleFormat &format,
                   int threads);
  template <class Sink>
  void draw_block(Tools &tools, const PictureView &view, int64_t x, int64_t y, int64_t columns, int64_t rows,
                  const Sink &sink, int threads) const;
  template <class T>
  TilePlanes<T> draw_channels(Tools &tools, KeptFloats &memory, const PictureView &view, const TileBlock &block,
                              int threads) const;
  // The same with the correction of restoration.
  void draw_restored(Restored &tools, const PictureView &view, int64_t x, int64_t y, const PixelBlock &block,
                     const SampleFormat &format, int threads) const;
  int64_t rows_seen(const OutputAxis &down) const;
  OutputAxis across(const PictureView &view, int64_t x, int64_t count) const;
  OutputAxis down(const PictureView &view, int64_t y, int64_t count) const;
  Tools tools_for(const PictureView &view, int threads);
  void rescale(const PictureView &view, int threads);

  const DecoderSettings &settings_;
  Header header_;
  PixelRect place_;
  bool is_empty_;
  std::vector<BandMask> masks_;
  std::vector<ExactSample> exact_;
  TileFacts facts_;
  GaussianSet gaussians_;
  std::vector<double> base_;
  std::unique_ptr<ArrivingTexture> texture_;
  std::optional<Restoration> restoration_;
  std::optional<Rescaled> rescaled_;
  std::optional<Whole> whole_;
};

}  // namespace sgi
