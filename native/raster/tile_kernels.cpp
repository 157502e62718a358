// What decoders draw: the same everywhere, since runs begin where the plane says and no product is fused with a sum.
#include "raster/tile_drawing.hpp"

namespace sgi {

const TileKernel TileKernel::SGI_ISA{draw_tile<Runs::kOfPlane>};

}  // namespace sgi
