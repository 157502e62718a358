// The fit's step as seen from Python (class SeedFit).
#pragma once
#include <nanobind/nanobind.h>

void bind_seed_fit(nanobind::module_ &m);
