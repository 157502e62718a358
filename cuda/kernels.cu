// All kernels, as one module.
#include "cuda/base/scan.hpp"
#include "cuda/fit/descent.hpp"
#include "cuda/fit/forward.hpp"
#include "cuda/fit/update.hpp"
#include "cuda/raster/binning.hpp"
#include "cuda/raster/reduction.hpp"
#include "cuda/raster/samples.hpp"
#include "cuda/raster/tiles.hpp"
