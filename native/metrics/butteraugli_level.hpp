// Butteraugli at one size of a picture: what the eye sees of an original, how much decoded pictures differ from that,
// and the way back of gradients.
#pragma once
#include <array>

#include "metrics/bordered_plane.hpp"
#include "metrics/butteraugli_kernel.hpp"
#include "metrics/malta_kernel.hpp"
#include "metrics/plane_blur.hpp"

namespace sgi {

template <int COUNT>
using BorderedPlanes = std::array<BorderedPlane, COUNT>;

// What the eye sees of a picture.
struct SeenPlanes {
  BorderedPlanes<3> lf, mf;
  BorderedPlanes<2> hf, uhf, rest;  // rest: what low and middle frequencies leave of the first two channels
  BorderedPlane mask;

  SeenRows<const float> rows(int64_t y) const;
  SeenRows<float> rows(int64_t y);
};

class ButteraugliLevel {
 public:
  // light: linear, in planes that mirror themselves kLightReach into their border.
  static constexpr int kLightReach = 2;
  ButteraugliLevel(const BorderedPlanes<3> &light, MapPlane size, int threads, Isa isa);

  MapPlane size() const { return size_; }

  // Of linear light as above.
  SeenPlanes see(const BorderedPlanes<3> &light) const;
  // How much each pixel differs.
  void compare(const SeenPlanes &seen, BorderedPlane &differences) const;
  // The gradient in what the opsin stage gives of light, from that in differences.
  BorderedPlanes<3> pull(SeenPlanes seen, BorderedPlane differences, BorderedPlane slope) const;
  // From there, the gradient in light.
  BorderedPlanes<3> pull_opsin(const BorderedPlanes<3> &light, const BorderedPlanes<3> &gradient) const;

 private:
  // Malta's differences of one channel of one band of frequencies.
  struct MaltaPart {
    const BorderedPlane *original, *seen;
    MaltaLines lines;
    MaltaWeights weights;
  };

  template <class Body>
  void each_row(Body body) const;
  BorderedPlane plane() const { return BorderedPlane(size_); }
  template <int COUNT>
  BorderedPlanes<COUNT> planes() const;
  OriginalRows original(int64_t y) const;
  BorderedPlanes<3> around(const BorderedPlanes<3> &light) const;
  BorderedPlane eroded(const BorderedPlane &mask) const;
  std::array<MaltaPart, 6> malta_parts(const SeenPlanes &seen) const;
  void move(const MaltaPart &part, BorderedPlane &moved) const;
  void pull_malta(const MaltaPart &part, const BorderedPlane &slope, BorderedPlane &moved, BorderedPlane &to) const;

  MapPlane size_;
  int threads_;
  const ButteraugliKernel &kernel_;
  const MaltaKernel &malta_;
  PlaneBlur light_blur_, low_blur_, middle_blur_, high_blur_, mask_blur_;
  SeenPlanes original_;  // without `rest`
  BorderedPlane details_, ground_;
};

}  // namespace sgi
