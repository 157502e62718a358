#include "model/texture.hpp"

#include <algorithm>
#include <vector>

#include "base/thread_pool.hpp"
#include "model/texture_drawing.hpp"

namespace sgi {

void draw_texture(const Texture &texture, const OutputAxis &x, const OutputAxis &y, int threads, Isa isa,
                  float *planes) {
  constexpr TextureBlocks kBlocks{0, 0, 128, 64, 128 + kTexturePadding};
  const TextureDrawing drawing(texture, x, y, kBlocks, isa);
  const int64_t across = drawing.across();
  parallel_for(across * drawing.down(), threads, [&](int64_t block) {
    std::vector<float> drawn(texture.channels * kBlocks.height * kBlocks.stride);
    drawing.draw(block % across, block / across, drawn.data());
    const int64_t left = block % across * kBlocks.width, top = block / across * kBlocks.height;
    const int64_t columns = std::min(kBlocks.width, x.count - left), rows = std::min(kBlocks.height, y.count - top);
    for (int c = 0; c < texture.channels; ++c)
      for (int64_t row = 0; row < rows; ++row)
        std::copy_n(&drawn[(c * kBlocks.height + row) * kBlocks.stride], columns,
                    planes + (c * y.count + top + row) * x.count + left);
  });
}

}  // namespace sgi
