// Prints the largest errors of exp2v, log2v and inverse_cube_root over their domains; built with sanitizers, it also
// shows that they are defined everywhere.
#include <cmath>
#include <cstdio>

#define LANES 4
#include "base/elementary.hpp"

using namespace sgi;

int main() {
  double exp_error = 0, log_error = 0, root_error = 0;
  for (double x = -700; x < 700; x += 0.0037) {
    const float at = static_cast<float>(x);
    const double found = exp2v(vf{} + at)[0];
    const double wanted = at < -126 ? 0 : std::exp2(at > 126 ? 126.0 : static_cast<double>(at));
    exp_error = std::fmax(exp_error, wanted == 0 ? std::fabs(found) : std::fabs(found / wanted - 1));
  }
  for (double x = -125; x < 127; x += 0.0037) {
    const float at = static_cast<float>(std::exp2(x));
    log_error = std::fmax(log_error, std::fabs(log2v(vf{} + at)[0] - std::log2(static_cast<double>(at))));
    const double root = inverse_cube_root(vf{} + at)[0];
    root_error = std::fmax(root_error, std::fabs(root * std::cbrt(static_cast<double>(at)) - 1));
  }
  const vf odd = {INFINITY, -INFINITY, NAN, 1e38f};
  std::printf("%.1e %.1e %.1e %g %g\n", exp_error, log_error, root_error, exp2v(odd)[1],
              exp2v(odd)[3] / std::exp2(126.0f));
}
