// The texture layer: windowed cosines in the cells of a quadtree (docs/format.md, "Texture").
#pragma once
#include "base/isa.hpp"
#include "model/texture_axis.hpp"

namespace sgi {

// The texture of a tile of width x height pixels.
struct Texture {
  const int32_t *corner;    // [N, 2]
  const uint8_t *log_size;  // [N] kTextureLeast ... kTextureRoot
  const float *amplitudes;  // of each cell [C, n, n], side n, one cell after the other
  int64_t count;
  int channels;
  int64_t width, height;
};

// Draws the texture to planes [C, y.count, x.count]. mix: [3, 3], to which the first three channels are multiplied
// transposed as Gaussians' colours are, null for none. Each pixel adds up its cells in their order.
void draw_texture(const Texture &texture, const OutputAxis &x, const OutputAxis &y, const float *mix, int threads,
                  Isa isa, float *planes);

}  // namespace sgi
