#include "base/exact.hpp"

#include <cmath>

namespace sgi {
namespace {

// 2^(i / 32), rounded to nearest.
constexpr double kRoots[32] = {
    0x1.0p+0,
    0x1.059b0d3158574p+0,
    0x1.0b5586cf9890fp+0,
    0x1.11301d0125b51p+0,
    0x1.172b83c7d517bp+0,
    0x1.1d4873168b9aap+0,
    0x1.2387a6e756238p+0,
    0x1.29e9df51fdee1p+0,
    0x1.306fe0a31b715p+0,
    0x1.371a7373aa9cbp+0,
    0x1.3dea64c123422p+0,
    0x1.44e086061892dp+0,
    0x1.4bfdad5362a27p+0,
    0x1.5342b569d4f82p+0,
    0x1.5ab07dd485429p+0,
    0x1.6247eb03a5585p+0,
    0x1.6a09e667f3bcdp+0,
    0x1.71f75e8ec5f74p+0,
    0x1.7a11473eb0187p+0,
    0x1.82589994cce13p+0,
    0x1.8ace5422aa0dbp+0,
    0x1.93737b0cdc5e5p+0,
    0x1.9c49182a3f090p+0,
    0x1.a5503b23e255dp+0,
    0x1.ae89f995ad3adp+0,
    0x1.b7f76f2fb5e47p+0,
    0x1.c199bdd85529cp+0,
    0x1.cb720dcef9069p+0,
    0x1.d5818dcfba487p+0,
    0x1.dfc97337b9b5fp+0,
    0x1.ea4afa2a490dap+0,
    0x1.f50765b6e4540p+0,
};
// Terms of Taylor's series, rounded to nearest: of sin(pi u) / u and cos(pi u) in u^2, of 2^x in x.
constexpr double kSine[] = {
    0x1.921fb54442d18p+1, -0x1.4abbce625be53p+2, 0x1.466bc6775aae2p+1,  -0x1.32d2cce62bd86p-1,
    0x1.50783487ee782p-4, -0x1.e3074fde8871fp-8, 0x1.e8f434d018d63p-12, -0x1.6fadb9f155744p-16,
};
constexpr double kCosine[] = {
    0x1.0p+0,
    -0x1.3bd3cc9be45dep+2,
    0x1.03c1f081b5ac4p+2,
    -0x1.55d3c7e3cbffap+0,
    0x1.e1f506891babbp-3,
    -0x1.a6d1f2a204a8cp-6,
    0x1.f9d38a3763cc3p-10,
    -0x1.b6e24f44b128fp-14,
    0x1.20c62c2f2d7f5p-18,
};
constexpr double kExponential[] = {
    0x1.0p+0,
    0x1.62e42fefa39efp-1,
    0x1.ebfbdff82c58fp-3,
    0x1.c6b08d704a0c0p-5,
    0x1.3b2ab6fba4e77p-7,
    0x1.5d87fe78a6731p-10,
    0x1.430912f86c787p-13,
    0x1.ffcbfc588b0c7p-17,
    0x1.62c0223a5c824p-20,
    0x1.b5253d395e7c4p-24,
    0x1.e4cf5158b8ecap-28,
    0x1.e8cac7351bb25p-32,
    0x1.c3bd650fc2986p-36,
    0x1.816193166d0f9p-40,
};

template <int N>
double polynomial(const double (&terms)[N], double x) {
  double sum = terms[N - 1];
  for (int i = N - 2; i >= 0; --i) sum = sum * x + terms[i];
  return sum;
}

// sin(pi u) of u = quarter / 2 + r with |r| <= 1/4.
double sine_of(double quarter, double r) {
  const double turn = quarter - 4 * std::floor(quarter / 4);  // 0, 1, 2 or 3
  const bool is_odd = turn == 1 || turn == 3;
  const double value = is_odd ? polynomial(kCosine, r * r) : r * polynomial(kSine, r * r);
  return turn >= 2 ? -value : value;
}

}  // namespace

double power_of_two(int k) { return std::ldexp(kRoots[k & 31], k >> 5); }

double sine_pi(double u) {
  const double quarter = std::floor(2 * u + 0.5);
  return sine_of(quarter, u - 0.5 * quarter);
}

double cosine_pi(double u) {
  const double quarter = std::floor(2 * u + 0.5);
  return sine_of(quarter + 1, u - 0.5 * quarter);
}

double exp2_of(double x) {
  if (x < -1022) return 0;
  const double whole = std::floor(x + 0.5);
  return std::ldexp(polynomial(kExponential, x - whole), int(whole));
}

}  // namespace sgi
