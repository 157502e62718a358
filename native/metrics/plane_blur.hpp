// Gaussian blurs of planes by what lies inside them alone, and their transposes.
#pragma once
#include <vector>

#include "metrics/bordered_plane.hpp"
#include "metrics/plane_blur_kernel.hpp"

namespace sgi {

enum class BlurBorder { kNone, kMirrored };

class PlaneBlur {
 public:
  // Reaches 2.25 sigma. kMirrored: planes must mirror themselves in as much of their border.
  PlaneBlur(double sigma, MapPlane size, BlurBorder border, int threads, Isa isa);

  int reach() const { return int(taps_.size()) - 1; }
  // The blur, in place of what `to` has inside.
  void blur(const BorderedPlane &from, BorderedPlane &to) const;
  // Adds the transposed blur: of the gradient in what `blur` gives, that in what it is given.
  void pull(const BorderedPlane &gradient, BorderedPlane &to) const;

 private:
  void run(const BorderedPlane &from, BorderedPlane &to, bool transposed) const;

  MapPlane size_;
  int threads_;
  const PlaneBlurKernel &kernel_;
  std::vector<float> taps_, ones_, rows_,
      columns_;  // in a border; rows_, columns_: 1 / the share of taps that lies inside
};

}  // namespace sgi
