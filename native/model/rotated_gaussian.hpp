// Covariances of Gaussians that are turned by an angle (paper, equations 2 and 3), for V a float or a vector of them.
#pragma once
#include "base/elementary.hpp"
#include "model/constants.hpp"

namespace sgi {
namespace {

// R diag((reach sigmoid(t))²) Rᵀ of two sizes t before their sigmoid and an angle; `reach` is the greatest standard
// deviation along either axis.
template <class V>
struct RotatedCovariance {
  V reach[2], share[2], squared[2], sine, cosine;  // share: the sigmoids
  decltype(V{} < V{}) is_free[2];                  // a size lies within its limits

  RotatedCovariance(const V *shape, V first_reach, V second_reach) {
    constexpr float kMax = float(kShapeLimit);
    reach[0] = first_reach;
    reach[1] = second_reach;
    for (int axis = 0; axis < 2; ++axis) {
      share[axis] = 1.0f / (1.0f + exp2v(-kLog2e * clampv(shape[axis], kMax)));
      is_free[axis] = absv(shape[axis]) < kMax;
      const V deviation = reach[axis] * share[axis];
      squared[axis] = deviation * deviation;
    }
    sine_cosine(shape[2], sine, cosine);
  }
  V xx() const { return cosine * cosine * squared[0] + sine * sine * squared[1]; }
  V xy() const { return cosine * sine * (squared[0] - squared[1]); }
  V yy() const { return sine * sine * squared[0] + cosine * cosine * squared[1]; }

  // Gradients of the shape and of the reaches from those of the covariance.
  void descend(V up_xx, V up_xy, V up_yy, V *shape, V *reaches) const {
    const V cc = cosine * cosine, ss = sine * sine, cs = cosine * sine;
    const V along[2] = {cc * up_xx + cs * up_xy + ss * up_yy, ss * up_xx - cs * up_xy + cc * up_yy};
    for (int axis = 0; axis < 2; ++axis) {
      const V deviation = 2.0f * reach[axis] * share[axis] * along[axis];
      reaches[axis] = deviation * share[axis];
      shape[axis] = select(is_free[axis], deviation * reach[axis] * share[axis] * (1.0f - share[axis]), V{});
    }
    shape[2] = (squared[0] - squared[1]) * ((cc - ss) * up_xy + 2.0f * cs * (up_yy - up_xx));
  }
};

}  // namespace
}  // namespace sgi
