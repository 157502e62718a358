// Who draws in the processor's place, such as a GPU.
#pragma once
#include "model/texture.hpp"
#include "raster/rasterizer.hpp"

namespace sgi {

// Texture behind Gaussians, as `draw_texture` takes it.
struct TextureView {
  Texture texture;
  OutputAxis x, y;
  const float *mix;
};

// Safe for use by several threads at once.
class Painter {
 public:
  virtual ~Painter() = default;
  // Of what it draws; the processor draws what has more.
  virtual int most_channels() const = 0;
  // As Rasterizer::draw, on texture too, unless that is null. Throws std::overflow_error for what is too much.
  virtual void draw(const Gaussians &g, const View &view, float cutoff, const Background &background,
                    const TextureView *texture, const Samples &samples) = 0;
};

}  // namespace sgi
