// Elementary functions of float64 that decoders compute with (docs/format.md, "Arithmetic"): the standard library's
// differ in their last bits from machine to machine.
#pragma once

namespace sgi {

// 2^(k / 32), rounded to nearest, for |k| < 2^15.
double power_of_two(int k);
// sin(pi u) and cos(pi u) for |u| < 2^20.
double sine_pi(double u);
double cosine_pi(double u);
// 2^x for -1022 <= x <= 1023, and 0 below.
double exp2_of(double x);

}  // namespace sgi
