// Python bindings of what pictures in files need.
#pragma once
#include <nanobind/nanobind.h>

void bind_image(nanobind::module_ &m);
