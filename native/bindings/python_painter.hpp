// A painter that is written in Python: it calls `paint` of an object (sgicodec/raster/painter.py).
#pragma once
#include <nanobind/nanobind.h>

#include <memory>

#include "decoder/painter.hpp"

namespace sgi {

std::shared_ptr<Painter> python_painter(nanobind::object painter);

}  // namespace sgi
