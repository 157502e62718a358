// Who draws in the processor's place, such as a GPU.
#pragma once
#include "model/texture_tables.hpp"
#include "raster/rasterizer.hpp"

namespace sgi {

// Safe for use by several threads at once.
class Painter {
 public:
  virtual ~Painter() = default;
  // Of what it draws; the processor draws what has more.
  virtual int most_channels() const = 0;
  // As Rasterizer::draw, on texture too, unless that is null. Throws std::overflow_error for too many pairs of tile and
  // Gaussian.
  virtual void draw(const Gaussians &g, const View &view, float cutoff, const Background &background,
                    const TextureTables *texture, const Samples &samples) = 0;
};

}  // namespace sgi
