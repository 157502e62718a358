// Python bindings of the search for symbols.
#pragma once
#include <nanobind/nanobind.h>

void bind_refine(nanobind::module_ &m);
