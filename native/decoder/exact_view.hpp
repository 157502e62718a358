// Views that show samples of a residual layer, wherever it says what they are.
#pragma once
#include <cstdint>

#include "decoder/exact_blocks.hpp"
#include "decoder/samples.hpp"
#include "decoder/view.hpp"

namespace sgi {

// Draws rows top ... top + block.rows - 1 of a view inside the picture into a block. `draw` draws without the layer, at
// the picture's own scale and in its own type. Where the layer has cells or alpha alone, the block holds what is drawn
// without it, and what it says nothing of stays. Throws Error (corrupt).
struct ExactView {
  const Header &header;
  const PictureView &view;
  const SampleFormat &format;
  const ExactBlocks::Draw &draw;
  bool dither;
  int threads;

  void fill(ExactBlocks &blocks, int64_t top, const PixelBlock &block) const;
};

}  // namespace sgi
