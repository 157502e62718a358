// Draws texture block by block, each while it is in the cache.
#pragma once
#include <cstdint>

#include "model/texture_bins.hpp"
#include "model/texture_kernel.hpp"

namespace sgi {

class TextureDrawing {
 public:
  // The texture's arrays must outlive it.
  TextureDrawing(const Texture &texture, const OutputAxis &x, const OutputAxis &y, const TextureBlocks &blocks,
                 Isa isa);

  int64_t across() const { return bins_.across; }
  int64_t down() const { return bins_.down; }
  // Writes a block [C, height, stride] from its first pixel on. False where it shows nothing: then nothing is written.
  // Safe for use by several threads at once.
  bool draw(int64_t column, int64_t row, float *planes) const;

 private:
  void add_cell(int64_t cell, int64_t x0, int64_t x1, int64_t y0, int64_t y1, int64_t left, int64_t top,
                float *planes) const;

  const Texture texture_;
  const TextureBlocks blocks_;
  const int64_t columns_, rows_;
  const TextureKernel &kernel_;
  const TextureAxis along_, downward_;
  const TextureBins bins_;
};

}  // namespace sgi
