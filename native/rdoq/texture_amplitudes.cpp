#include "rdoq/texture_amplitudes.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"
#include "bitstream/texture_stream.hpp"
#include "rdoq/texture_transform.hpp"

namespace sgi {

namespace {

constexpr int64_t kRoot = 1 << kTextureRoot;

// body(at, steps) for the rows of all roots in [height, width] amplitudes: the first of kRoot, and the step of each.
template <class Body>
void each_row(int64_t width, int64_t height, int log, const float *growth, const float *root_steps, Body body) {
  const int side = 1 << log;
  std::array<float, kRoot> steps;
  for (int64_t y = 0; y < height; ++y) {
    const float *row_growth = growth + ((y & (side - 1)) << log), *root = root_steps + y / kRoot * (width / kRoot);
    for (int64_t x = 0; x < width; x += kRoot) {
      for (int64_t u = 0; u < kRoot; ++u) steps[u] = root[x / kRoot] * row_growth[u & (side - 1)];
      body(y * width + x, steps.data());
    }
  }
}

}  // namespace

TextureAmplitudes::TextureAmplitudes(const float *planes, int channels_, int64_t tile_width_, int64_t tile_height_,
                                     int threads_, const TextureColours &colours)
    : threads(threads_), channels(channels_), tile_width(tile_width_), tile_height(tile_height_),
      width(texture_roots(tile_width_) << kTextureRoot), height(texture_roots(tile_height_) << kTextureRoot),
      colours_(colours) {
  const std::array<double, 9> into = colours.inverse();
  if (!colours.same()) shares_ = {0, float(-into[3]), float(-into[6])};
  const std::vector<float> mixed = in_colours(planes, into);
  if (!mixed.empty()) planes = mixed.data();
  for (auto &plane : sizes_) plane.resize(size_t(width * height * channels));
  parallel_for(kTextureSizes * channels, threads, [&](int64_t job) {
    const int64_t size = job / channels, at = job % channels * width * height;
    analyse_texture(planes + at, width, height, int(size) + kTextureLeast, sizes_[size].data() + at);
  });
}

// Planes [C, height, width] that are mixed so, none where they may stay as they are.
std::vector<float> TextureAmplitudes::in_colours(const float *planes, const std::array<double, 9> &mix) const {
  if (colours_.same()) return {};
  std::vector<float> mixed(planes, planes + width * height * channels);
  mix_colours(mix, mixed.data(), width * height);
  return mixed;
}

void TextureAmplitudes::move(const float *gradient, const int8_t *contrast, const TextureSteps &steps, float mean,
                             float most, const uint8_t *log_size) {
  const std::vector<float> mixed = in_colours(gradient, transposed(colours_.matrix()));
  if (!mixed.empty()) gradient = mixed.data();
  const int64_t plane = width * height, roots = plane >> 2 * kTextureRoot, units = plane / (kUnit * kUnit);
  std::vector<float> gains(size_t(plane * channels)), root_steps(size_t(roots * channels));
  for (int64_t i = 0; i < roots * channels; ++i) root_steps[i] = steps.of(int(i / roots), contrast[i % roots]);
  for (int size = 0; size < kTextureSizes; ++size) {
    const int log = size + kTextureLeast;
    std::vector<double> sums(channels);
    parallel_for(channels, threads, [&](int64_t channel) {
      float *gain = &gains[channel * plane];
      analyse_texture(gradient + channel * plane, width, height, log, gain, log_size);
      each_row(width, height, log, steps.growth(int(channel), log), &root_steps[channel * roots],
               [&](int64_t at, const float *step) {
                 for (int64_t i = 0; i < kRoot; ++i) sums[channel] += std::abs(gain[at + i] *= step[i]);
               });
    });
    double sum = 0;
    for (const double one : sums) sum += one;
    const int64_t moved = log_size ? int64_t(kUnit * kUnit) * std::count(log_size, log_size + units, log) : plane;
    const double unit = mean * double(moved * channels) / sum;
    if (!std::isfinite(unit)) continue;
    parallel_for(channels, threads, [&](int64_t channel) {
      const float *gain = &gains[channel * plane];
      float *amplitude = &sizes_[size][channel * plane];
      each_row(width, height, log, steps.growth(int(channel), log), &root_steps[channel * roots],
               [&](int64_t at, const float *step) {
                 for (int64_t i = at; i < at + kRoot; ++i) {
                   const float most_of_it = std::min(step[i - at], std::abs(amplitude[i]));
                   amplitude[i] += most_of_it * std::clamp(float(unit) * gain[i], -most, most);
                 }
               });
    });
  }
}

}  // namespace sgi
