#include "metrics/visual_reference.hpp"

#include <algorithm>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

int64_t size_of(const MapPlane &plane) { return plane.height * padded(plane.width); }

// What `slope` finds in one channel around the rows that a thread is at.
class SlopeRings {
 public:
  SlopeRings(const MapPlane &plane, bool structure)
      : stride_(padded(plane.width)), memory_(floats((structure ? 4 : 2) * kRingRows * stride_)),
        structure_(structure) {}

  // Rings where `y` is 0, else their row.
  BlurSlopes slopes(int64_t y = 0) const {
    return {row(0, y), structure_ ? row(2, y) : nullptr, structure_ ? row(3, y) : nullptr, row(1, y)};
  }

  int64_t end = 0;  // behind the last row that is there

 private:
  float *row(int ring, int64_t y) const { return memory_.get() + (ring * kRingRows + y % kRingRows) * stride_; }

  int64_t stride_;
  Floats memory_;
  bool structure_;
};

}  // namespace

VisualReference::VisualReference(const SrgbPicture &original, int threads, Isa isa)
    : channels_(original.channels), threads_(threads), height_(original.height), width_(original.width),
      colour_kernel_(kernel_for<ColourKernel>(isa)), kernel_(kernel_for<StructureKernel>(isa)),
      original_(original, nullptr, threads, colour_kernel_) {
  original_.keep_xyb();
  for (const MapPlane &plane : visual_scales(height_, width_)) scales_.push_back({plane, {}});
  const int count = int(scales_.size());
  for (int scale = 0; scale < count; ++scale)
    for (int c = 0; c < kVisualChannels; ++c) {
      Channel &channel = scales_[scale].channels[c];
      const bool structure = counts(count, scale, c, kStructure);
      channel.used = structure || counts(count, scale, c, kAdded) || counts(count, scale, c, kLost);
      if (channel.used) channel.mean = floats(size_of(scales_[scale].plane));
      if (structure) channel.variance = floats(size_of(scales_[scale].plane));
      if (channel.used) describe(scale, c);
    }
}

void VisualReference::describe(size_t scale, int channel) {
  const MapPlane plane = scales_[scale].plane;
  Channel &described = scales_[scale].channels[channel];
  each_band(plane.height, threads_, [&](int64_t, int64_t begin, int64_t end) {
    const Floats scratch = floats(kScratchRows * scratch_row(plane.width));
    for (int64_t y = begin; y < end; ++y) {
      const int64_t row = y * padded(plane.width);
      kernel_.describe(original_.xyb(scale, channel), plane, y, at(described.mean, row), at(described.variance, row),
                       scratch.get());
    }
  });
}

SrgbPicture VisualReference::shaped(const float *samples) const { return {samples, channels_, height_, width_}; }

ReferencePlanes VisualReference::planes(size_t scale, int channel) const {
  const Channel &known = scales_[scale].channels[channel];
  return {original_.xyb(scale, channel), known.mean.get(), known.variance.get()};
}

std::vector<ChannelSums> VisualReference::compare(const ColourPyramid &decoded) const {
  struct Band {
    size_t scale;
    int64_t number;
  };
  std::vector<Band> bands;
  for (size_t scale = 0; scale < scales_.size(); ++scale)
    for (int64_t number = 0; number < bands_of(scales_[scale].plane.height); ++number) bands.push_back({scale, number});
  std::vector<ChannelSums> found(bands.size(), ChannelSums{}), sums(scales_.size(), ChannelSums{});
  parallel_for(int64_t(bands.size()), threads_,
               [&](int64_t i) { found[i] = compare_band(decoded, bands[i].scale, bands[i].number); });
  for (size_t i = 0; i < bands.size(); ++i)
    for (int c = 0; c < kVisualChannels; ++c)
      for (int norm = 0; norm < 2 * kVisualMaps; ++norm) sums[bands[i].scale][c].sum[norm] += found[i][c].sum[norm];
  return sums;
}

ChannelSums VisualReference::compare_band(const ColourPyramid &decoded, size_t scale, int64_t band) const {
  ChannelSums sums{};
  const MapPlane plane = scales_[scale].plane;
  const Floats scratch = floats(kScratchRows * scratch_row(plane.width));
  for (int c = 0; c < kVisualChannels; ++c)
    if (scales_[scale].channels[c].used)
      for (int64_t y = band * kBandRows; y < std::min(plane.height, (band + 1) * kBandRows); ++y)
        kernel_.compare(planes(scale, c), decoded.xyb(scale, c), plane, y, sums[c], scratch.get());
  return sums;
}

double VisualReference::finish(const std::vector<ChannelSums> &sums, std::vector<ChannelSlopes> *slopes) const {
  std::vector<int64_t> pixels;
  for (const Scale &scale : scales_) pixels.push_back(scale.plane.width * scale.plane.height);
  return visual_score(sums, pixels, slopes);
}

double VisualReference::score(const float *decoded) const {
  const ColourPyramid pyramid(shaped(decoded), &original_, threads_, colour_kernel_);
  return finish(compare(pyramid), nullptr);
}

double VisualReference::gradient(const float *decoded, float *gradient) const {
  const SrgbPicture picture = shaped(decoded);
  ColourPyramid pyramid(picture, &original_, threads_, colour_kernel_);
  std::vector<ChannelSlopes> slopes;
  const double score = finish(compare(pyramid), &slopes);
  const int colours = scales_.empty() ? 0 : picture.colours();
  std::fill(gradient + colours * height_ * width_, gradient + channels_ * height_ * width_, 0.0f);
  for (size_t scale = scales_.size(); scale-- > 0;)
    parallel_for(bands_of(scales_[scale].plane.height), threads_,
                 [&](int64_t band) { pull_band(pyramid, slopes[scale], scale, band, picture, gradient); });
  return score;
}

void VisualReference::pull_band(ColourPyramid &decoded, const ChannelSlopes &slopes, size_t scale, int64_t band,
                                const SrgbPicture &picture, float *gradient) const {
  const MapPlane plane = scales_[scale].plane;
  const int64_t stride = padded(plane.width), begin = band * kBandRows;
  std::vector<SlopeRings> rings;
  for (int c = 0; c < kVisualChannels; ++c) {
    rings.emplace_back(plane, bool(scales_[scale].channels[c].variance));
    rings[c].end = std::max<int64_t>(0, begin - kNeighbourRows);
  }
  const Floats scratch = floats(kScratchRows * scratch_row(plane.width)), rows = floats(2 * kVisualChannels * stride);
  for (int64_t y = begin; y < std::min(plane.height, begin + kBandRows); ++y) {
    float *found[kVisualChannels];
    for (int c = 0; c < kVisualChannels; ++c) {
      found[c] = rows.get() + c * stride;
      if (!scales_[scale].channels[c].used) {
        std::fill(found[c], found[c] + stride, 0.0f);
        continue;
      }
      const ReferencePlanes reference = planes(scale, c);
      SlopeRings &ring = rings[c];
      for (; ring.end <= std::min(y + kNeighbourRows, plane.height - 1); ++ring.end)
        kernel_.slope(reference, decoded.xyb(scale, c), plane, ring.end, slopes[c].data(), ring.slopes(ring.end),
                      scratch.get());
      kernel_.gather(reference, decoded.xyb(scale, c), ring.slopes(), plane, y, found[c], scratch.get());
    }
    decoded.pull_row(original_, scale, y, found, rows.get() + kVisualChannels * stride, picture, gradient);
  }
}

}  // namespace sgi
