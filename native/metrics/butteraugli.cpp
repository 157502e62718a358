#include "metrics/butteraugli.hpp"

#include <cmath>

#include "metrics/bands.hpp"

namespace sgi {
namespace {

constexpr int64_t kSmallestHalved = 15;  // pixels of a side from which on half the size is looked at, too
constexpr double kFullShare = 0.85, kHalfShare = 0.5;
constexpr double kMinDifference = 1e-6;
constexpr int kNorms = 3;
constexpr int kPower[kNorms] = {3, 6, 12};

// Powers of a difference, as in kPower.
std::array<double, kNorms> powers(double value) {
  const double three = value * value * value, six = three * three;
  return {three, six, six * six};
}

}  // namespace

// Of a map.
struct ButteraugliReference::Norms {
  std::array<double, kNorms> norm{};

  double mean() const { return (norm[0] + norm[1] + norm[2]) / kNorms; }
};

ButteraugliReference::ButteraugliReference(const SrgbPicture &original, int threads, Isa isa)
    : channels_(original.channels), threads_(threads), size_{original.width, original.height},
      colour_kernel_(kernel_for<ColourKernel>(isa)) {
  const int64_t least = std::min(size_.width, size_.height);
  if (least < kSmallestSeen) return;
  const BorderedPlanes<3> light = linear(original.samples);
  full_ = std::make_unique<ButteraugliLevel>(light, size_, threads, isa);
  if (least < kSmallestHalved) return;
  const BorderedPlanes<3> half = halved(light);
  half_ = std::make_unique<ButteraugliLevel>(half, half[0].size(), threads, isa);
}

// Light of all three colours: of gray pictures, three times the same.
BorderedPlanes<3> ButteraugliReference::linear(const float *samples) const {
  const SrgbPicture picture = shaped(samples);
  BorderedPlanes<3> light;
  for (int c = 0; c < 3; ++c) {
    BorderedPlane &plane = light[size_t(c)] = BorderedPlane(size_);
    const int from = std::min(c, picture.colours() - 1);
    each_band(size_.height, threads_, [&](int64_t, int64_t begin, int64_t end) {
      for (int64_t y = begin; y < end; ++y) colour_kernel_.linearize(picture.row(from, y), size_.width, plane.row(y));
    });
    plane.mirror_border(ButteraugliLevel::kLightReach);
  }
  return light;
}

BorderedPlanes<3> ButteraugliReference::halved(const BorderedPlanes<3> &light) const {
  const MapPlane size{(size_.width + 1) / 2, (size_.height + 1) / 2};
  BorderedPlanes<3> half;
  for (size_t c = 0; c < 3; ++c) {
    half[c] = BorderedPlane(size);
    each_band(size.height, threads_, [&](int64_t, int64_t begin, int64_t end) {
      for (int64_t y = begin; y < end; ++y)
        colour_kernel_.halve(light[c].row(2 * y), 2 * y + 1 < size_.height ? light[c].row(2 * y + 1) : nullptr,
                             size_.width, half[c].row(y));
    });
    half[c].mirror_border(ButteraugliLevel::kLightReach);
  }
  return half;
}

ButteraugliReference::Seen ButteraugliReference::see(const ButteraugliLevel &level, const BorderedPlanes<3> &light,
                                                     bool keep) {
  Seen seen{level.see(light), BorderedPlane(level.size())};
  level.compare(seen.planes, seen.differences);
  if (!keep) seen.planes = {};
  return seen;
}

// At full and at half the size, where that is looked at.
std::array<ButteraugliReference::Seen, 2> ButteraugliReference::see_both(const float *decoded, bool keep) const {
  const BorderedPlanes<3> light = linear(decoded);
  std::array<Seen, 2> seen;
  if (half_) seen[1] = see(*half_, halved(light), keep);
  seen[0] = see(*full_, light, keep);
  return seen;
}

// The map of both sizes, and its norms.
ButteraugliReference::Norms ButteraugliReference::join(const std::array<Seen, 2> &seen, float *map) const {
  std::vector<std::array<double, kNorms>> bands(size_t(bands_of(size_.height)));
  each_band(size_.height, threads_, [&](int64_t band, int64_t begin, int64_t end) {
    std::array<double, kNorms> sums{};
    for (int64_t y = begin; y < end; ++y) {
      const float *fine = seen[0].differences.row(y), *coarse = half_ ? seen[1].differences.row(y / 2) : nullptr;
      for (int64_t x = 0; x < size_.width; ++x) {
        float &value = map[y * size_.width + x];
        value = coarse ? float(kFullShare) * fine[x] + float(kHalfShare) * coarse[x / 2] : fine[x];
        const std::array<double, kNorms> power = powers(double(value));
        for (size_t n = 0; n < kNorms; ++n) sums[n] += power[n];
      }
    }
    bands[size_t(band)] = sums;
  });
  Norms found;
  for (size_t n = 0; n < kNorms; ++n) {
    double mean = 0;
    for (const auto &sums : bands) mean += sums[n] / double(size_.width * size_.height);
    found.norm[n] = std::pow(mean, 1.0 / kPower[n]);
  }
  return found;
}

double ButteraugliReference::distance(const float *decoded, float *map) const {
  if (full_) return join(see_both(decoded, false), map).mean();
  std::fill_n(map, size_.width * size_.height, 0.0f);
  return 0;
}

// Gradients in the differences of both sizes.
std::array<BorderedPlane, 2> ButteraugliReference::slopes(const float *map, const Norms &norms) const {
  std::array<double, kNorms> factor;
  for (int i = 0; i < kNorms; ++i)
    factor[size_t(i)] =
        1 / (kNorms * std::pow(norms.norm[size_t(i)], kPower[i] - 1) * double(size_.width) * double(size_.height));
  std::array<BorderedPlane, 2> found{BorderedPlane(size_), {}};
  if (half_) found[1] = BorderedPlane(half_->size());
  if (half_) found[1].clear();
  each_band((size_.height + 1) / 2, threads_, [&](int64_t, int64_t begin, int64_t end) {
    for (int64_t y = 2 * begin; y < std::min(2 * end, size_.height); ++y)
      for (int64_t x = 0; x < size_.width; ++x) {
        const double value = double(map[y * size_.width + x]);
        const std::array<double, kNorms> power = powers(value);
        double sum = 0;
        for (size_t n = 0; n < kNorms; ++n) sum += factor[n] * power[n];
        sum /= std::max(value, kMinDifference);
        found[0].row(y)[x] = float(half_ ? kFullShare * sum : sum);
        if (half_) found[1].row(y / 2)[x / 2] += float(kHalfShare * sum);
      }
  });
  return found;
}

double ButteraugliReference::gradient(const float *decoded, float *map, float *gradient) const {
  std::fill_n(gradient, channels_ * size_.width * size_.height, 0.0f);
  if (!full_) return distance(decoded, map);
  std::array<Seen, 2> seen = see_both(decoded, true);
  const Norms norms = join(seen, map);
  BorderedPlanes<3> in_opsin, in_light, in_half;
  {
    std::array<BorderedPlane, 2> slope = slopes(map, norms);
    in_opsin = full_->pull(std::move(seen[0].planes), std::move(seen[0].differences), std::move(slope[0]));
    const BorderedPlanes<3> light = linear(decoded);  // again: until here its memory serves others
    in_light = full_->pull_opsin(light, in_opsin);
    if (half_) {
      in_opsin = half_->pull(std::move(seen[1].planes), std::move(seen[1].differences), std::move(slope[1]));
      in_half = half_->pull_opsin(halved(light), in_opsin);
    }
  }
  const SrgbPicture picture = shaped(decoded);
  each_band(size_.height, threads_, [&](int64_t, int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) {
      float *row[3];
      for (int c = 0; c < 3; ++c) {
        row[c] = in_light[size_t(c)].row(y);
        if (half_)
          colour_kernel_.add_doubled(in_half[size_t(c)].row(y / 2), y / 2 * 2 + 1 < size_.height ? 2 : 1, size_.width,
                                     row[c]);
      }
      if (picture.colours() == 1)  // all three are of one gray
        for (int64_t x = 0; x < size_.width; ++x) row[0][x] += row[1][x] + row[2][x];
      for (int c = 0; c < picture.colours(); ++c)
        colour_kernel_.to_sample_gradient(picture.row(c, y), row[c], size_.width,
                                          gradient + (c * size_.height + y) * size_.width);
    }
  });
  return norms.mean();
}

}  // namespace sgi
