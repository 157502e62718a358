// All kernels, as one module.
#include "cuda/base/scan.hpp"
#include "cuda/fit/features.hpp"
#include "cuda/fit/rows.hpp"
#include "cuda/raster/binning.hpp"
#include "cuda/raster/reduction.hpp"
#include "cuda/raster/tiles.hpp"
