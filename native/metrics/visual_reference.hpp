// A picture that decoded ones are compared with by SSIMULACRA 2: their scores, and the gradients of these.
#pragma once
#include <memory>
#include <vector>

#include "base/isa.hpp"
#include "metrics/colour_pyramid.hpp"
#include "metrics/structure_kernel.hpp"

namespace sgi {

// What is the same for every decoded picture is computed once: 40 bytes per pixel with three colours. Each call takes
// 20 bytes per pixel more while it runs: blurs are computed again for the gradient, which takes no longer than new
// memory for them. Calls may run at once, and give the same for any number of threads.
class VisualReference {
 public:
  // Samples beyond 0..1 are clipped.
  VisualReference(const SrgbPicture &original, int threads, Isa isa);
  VisualReference(const VisualReference &) = delete;
  VisualReference &operator=(const VisualReference &) = delete;

  // The score of a decoded picture of the original's shape [channels][height][width].
  double score(const float *decoded) const;

  // The score, and its gradient in the samples; 0 for samples that are clipped and for channels that count nothing.
  double gradient(const float *decoded, float *gradient) const;

 private:
  struct Channel {
    Floats mean, variance;  // none where they are not needed
    bool used = false;
  };
  struct Scale {
    MapPlane plane;
    std::array<Channel, kVisualChannels> channels;
  };

  SrgbPicture shaped(const float *samples) const;
  ReferencePlanes planes(size_t scale, int channel) const;
  void describe(size_t scale, int channel);
  std::vector<ChannelSums> compare(const ColourPyramid &decoded) const;
  ChannelSums compare_band(const ColourPyramid &decoded, size_t scale, int64_t band) const;
  double finish(const std::vector<ChannelSums> &sums, std::vector<ChannelSlopes> *slopes) const;
  void pull_band(ColourPyramid &decoded, const ChannelSlopes &slopes, size_t scale, int64_t band,
                 const SrgbPicture &picture, float *gradient) const;

  int channels_, threads_;
  int64_t height_, width_;
  const ColourKernel &colour_kernel_;
  const StructureKernel &kernel_;
  ColourPyramid original_;
  std::vector<Scale> scales_;
};

}  // namespace sgi
