// The colours in which a tile's texture is cheapest.
#pragma once
#include <cstdint>

#include "model/texture_colours.hpp"
#include "rdoq/texture_search.hpp"

namespace sgi {

// By an estimate over some of the roots, in cells of 16 pixels. planes: [C, height, width] of the roots in the tile's
// channels, C at least 3; contrast: [roots], indices; separate: as in TextureGrid.
TextureColours cheapest_colours(const float *planes, int64_t width, int64_t height, const int8_t *contrast,
                                const TextureSteps &steps, float lambda, bool separate, int threads);

}  // namespace sgi
