// Python bindings of the rasteriser, of nearest neighbours and of what the processor can do.
#pragma once
#include <nanobind/nanobind.h>

void bind_raster(nanobind::module_ &m);
