// Tiles become a view, with a cross-fade where they overlap.
#pragma once
#include <functional>

#include "decoder/samples.hpp"
#include "decoder/tile_cache.hpp"
#include "decoder/view.hpp"

namespace sgi {

// How a view is drawn: with dither or not, and what is called between its parts; it may throw.
struct Drawing {
  const SampleFormat &format;
  bool dither;
  int threads;
  const std::function<void()> &between;
};

// Decodes the tiles that the rows of a view touch, as many as are kept while they are rendered.
void decode_tiles(const Header &header, TileCache &tiles, const PictureView &view,
                  const std::function<void()> &between);

// Fills a block with the view from its row `top` on.
void draw_view(const Header &header, TileCache &tiles, const PictureView &view, int64_t top, const PixelBlock &block,
               const Drawing &drawing);

}  // namespace sgi
