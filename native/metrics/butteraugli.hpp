// A picture that decoded ones are compared with by Butteraugli: distances, and the gradients of these.
//
// Source: libjxl 0.7, lib/jxl/butteraugli/butteraugli.cc, and what its butteraugli_main prints as the 3-norm.
#pragma once
#include <memory>

#include "base/isa.hpp"
#include "metrics/butteraugli_level.hpp"
#include "metrics/colour_kernel.hpp"
#include "metrics/colour_pyramid.hpp"

namespace sgi {

constexpr int64_t kSmallestSeen = 8;  // pixels of a side below which nothing differs

// Holds 65 bytes per pixel of the original and takes 115 more while a gradient is asked for. Calls may run at once, and
// give the same for any number of threads.
class ButteraugliReference {
 public:
  // Samples beyond 0..1 are clipped.
  ButteraugliReference(const SrgbPicture &original, int threads, Isa isa);
  ButteraugliReference(const ButteraugliReference &) = delete;
  ButteraugliReference &operator=(const ButteraugliReference &) = delete;

  // The mean of the 3-, 6- and 12-norm of the differences of a decoded picture of the original's shape; `map`: these
  // differences [height][width].
  double distance(const float *decoded, float *map) const;
  // That, and its gradient in the samples [channels][height][width]; 0 for samples that are clipped and for channels
  // that count nothing.
  double gradient(const float *decoded, float *map, float *gradient) const;

 private:
  // A decoded picture at one size; what is seen is kept for gradients alone.
  struct Seen {
    SeenPlanes planes;
    BorderedPlane differences;
  };

  struct Norms;

  BorderedPlanes<3> linear(const float *samples) const;
  BorderedPlanes<3> halved(const BorderedPlanes<3> &light) const;
  static Seen see(const ButteraugliLevel &level, const BorderedPlanes<3> &light, bool keep);
  std::array<Seen, 2> see_both(const float *decoded, bool keep) const;
  Norms join(const std::array<Seen, 2> &seen, float *map) const;
  std::array<BorderedPlane, 2> slopes(const float *map, const Norms &norms) const;
  SrgbPicture shaped(const float *samples) const { return {samples, channels_, size_.height, size_.width}; }

  int channels_, threads_;
  MapPlane size_;
  const ColourKernel &colour_kernel_;
  std::unique_ptr<ButteraugliLevel> full_, half_;  // null where a side is too small
};

}  // namespace sgi
