// A picture in the XYB colours of SSIMULACRA 2 at each of its scales, which are halved in linear light.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "metrics/bands.hpp"
#include "metrics/colour_kernel.hpp"
#include "metrics/maps.hpp"
#include "metrics/ssimulacra2.hpp"

namespace sgi {

// Unset floats.
using Floats = std::unique_ptr<float[]>;
inline Floats floats(int64_t count) { return Floats(new float[size_t(count)]); }
inline float *at(const Floats &floats, int64_t offset) { return floats ? floats.get() + offset : nullptr; }

// sRGB samples [channels][height][width]. With fewer than three channels, the first is gray; those behind the third
// count nothing.
struct SrgbPicture {
  const float *samples;
  int channels;
  int64_t height, width;

  int colours() const { return channels < kVisualChannels ? 1 : kVisualChannels; }
  const float *row(int channel, int64_t y) const { return samples + (channel * height + y) * width; }
};

// The scales of a picture, none if a side is too small.
std::vector<MapPlane> visual_scales(int64_t height, int64_t width);

class ColourPyramid {
 public:
  // XYB of the picture; less that of another pyramid of this size, if there is one.
  ColourPyramid(const SrgbPicture &picture, const ColourPyramid *less, int threads, const ColourKernel &kernel);

  // Frees what only gradients need.
  void keep_xyb();

  // Planes of a channel at each scale.
  const float *xyb(size_t scale, int channel) const { return scales_[scale].xyb[channel].get(); }

  // Takes gradients in the planes of a scale, coarse scales first, to linear light; `rows` [3][padded(width)] hold one
  // row. At the finest scale the gradient in samples goes to `out`, rows of each colour.
  void pull_row(const ColourPyramid &reference, size_t scale, int64_t y, const float *const gradient[3], float *rows,
                const SrgbPicture &picture, float *out);

 private:
  struct Scale {
    MapPlane plane;
    std::array<Floats, kVisualChannels> xyb, linear;  // linear: none at the finest; gradients, once they are known
  };

  void convert_band(const SrgbPicture &picture, const ColourPyramid *less, size_t scale, int64_t band);

  const ColourKernel &kernel_;
  int colours_;
  std::vector<Scale> scales_;
};

}  // namespace sgi
