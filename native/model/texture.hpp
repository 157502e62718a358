// The texture layer: windowed cosines in the cells of a quadtree (docs/format.md, "Texture").
#pragma once
#include "base/isa.hpp"
#include "model/texture_axis.hpp"
#include "model/texture_grid.hpp"

namespace sgi {

// Of a channel of a cell, rows, a multiple of four, and columns of amplitudes behind which all are zero; such rows need
// not be there.
struct Waves {
  uint8_t down = 0, across = 0;
};

// The texture of a tile of width x height pixels.
struct Texture {
  const int32_t *corner;           // [N, 2]
  const uint8_t *log_size;         // [N] kTextureLeast ... kTextureRoot
  const float *const *amplitudes;  // [N, C] of each cell [n, n], side n
  const Waves *waves;              // [N, C]
  int64_t count;
  int channels;
  int64_t width, height;
  TextureGrid grid;
};

// Draws the texture to planes [C, y.count, x.count]. Each pixel adds up its cells in their order.
void draw_texture(const Texture &texture, const OutputAxis &x, const OutputAxis &y, int threads, Isa isa,
                  float *planes);

}  // namespace sgi
