// Python bindings of what lies between symbols and arrays.
#pragma once
#include <nanobind/nanobind.h>

void bind_bitstream(nanobind::module_ &m);
void bind_tree(nanobind::module_ &m);
void bind_reading(nanobind::module_ &m);
