// Draws texture block by block, each while it is in the cache.
#pragma once
#include <cstdint>
#include <memory>

#include "model/texture.hpp"

namespace sgi {

// Blocks of pixels, the first of which begins so many pixels before the first pixel; stride: of a row of a block, at
// least its width and kTexturePadding.
struct TextureBlocks {
  int64_t before, above, width, height, stride;
};

class TextureDrawing {
 public:
  // The texture's arrays must outlive it.
  TextureDrawing(const Texture &texture, const OutputAxis &x, const OutputAxis &y, const TextureBlocks &blocks,
                 Isa isa);
  ~TextureDrawing();

  int64_t across() const;
  int64_t down() const;
  // Writes a block [C, height, stride] from its first pixel on. False where it shows nothing: then nothing is written.
  // Safe for use by several threads at once.
  bool draw(int64_t column, int64_t row, float *planes) const;

 private:
  struct Prepared;
  std::unique_ptr<const Prepared> prepared_;
};

}  // namespace sgi
