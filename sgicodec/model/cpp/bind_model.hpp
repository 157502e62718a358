// Python bindings of the model's integer arithmetic.
#pragma once
#include <nanobind/nanobind.h>

void bind_model(nanobind::module_ &m);
