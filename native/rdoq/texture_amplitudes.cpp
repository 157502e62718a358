#include "rdoq/texture_amplitudes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/thread_pool.hpp"
#include "bitstream/texture_stream.hpp"

namespace sgi {

namespace {

constexpr int64_t kRoot = 1 << kTextureRoot;
constexpr int kLanes = 1 << kTextureLeast;  // of a row of a cell, side by side

using CellRow = std::array<float, kRoot>;

// body(at, steps) for the rows of cells of a size in [height, width] amplitudes: the first of side, and the step of
// each. log_size: as of `analyse_texture`.
template <class Body>
void each_cell_row(int64_t width, int64_t height, int log, const uint8_t *log_size, const float *growth,
                   const float *root_steps, Body body) {
  const int side = 1 << log;
  CellRow steps;
  for (int64_t y = 0; y < height; y += side)
    for (int64_t x = 0; x < width; x += side) {
      if (!is_of_size(log_size, width, x, y, log)) continue;
      const float root = root_steps[y / kRoot * (width / kRoot) + x / kRoot];
      for (int64_t v = 0; v < side; ++v) {
        for (int u = 0; u < side; ++u) steps[size_t(u)] = root * growth[(v << log) + u];
        body((y + v) * width + x, steps);
      }
    }
}

// Multiplies gains by steps; their magnitudes, summed.
float weigh(float *gain, const CellRow &steps, int side) {
  std::array<float, kLanes> sums{};
  for (int u = 0; u < side; u += kLanes)
    for (int i = 0; i < kLanes; ++i) {
      gain[u + i] *= steps[size_t(u + i)];
      sums[size_t(i)] += std::abs(gain[u + i]);
    }
  return std::accumulate(sums.begin(), sums.end(), 0.0f);
}

}  // namespace

TextureAmplitudes::TextureAmplitudes(const float *planes, int channels_, const TextureLayout &layout_, int threads_,
                                     const TextureColours &colours)
    : threads(threads_), channels(channels_), layout(layout_), width(texture_roots(layout.width) << kTextureRoot),
      height(texture_roots(layout.height) << kTextureRoot), colours_(colours) {
  const std::array<double, 9> into = colours.inverse();
  if (!colours.same()) shares_ = {0, float(-into[3]), float(-into[6])};
  const std::vector<float> mixed = in_colours(planes, into);
  if (!mixed.empty()) planes = mixed.data();
  for (auto &planes_of_size : sizes_) planes_of_size.reset(new float[size_t(width * height * channels)]);
  parallel_for(kTextureSizes * channels, threads, [&](int64_t job) {
    const int64_t size = job / channels, at = job % channels * width * height;
    analyse_texture(planes + at, width, height, layout, int(size) + kTextureLeast, sizes_[size].get() + at);
  });
}

// Planes [C, height, width] that are mixed so, none where they may stay as they are.
std::vector<float> TextureAmplitudes::in_colours(const float *planes, const std::array<double, 9> &mix) const {
  if (colours_.same()) return {};
  std::vector<float> mixed(planes, planes + width * height * channels);
  mix_colours(mix, mixed.data(), width * height, width * height);
  return mixed;
}

void TextureAmplitudes::move(const float *gradient, const int8_t *contrast, const TextureSteps &steps, float mean,
                             float most, const uint8_t *log_size) {
  const std::vector<float> mixed = in_colours(gradient, transposed(colours_.matrix()));
  if (!mixed.empty()) gradient = mixed.data();
  const int64_t plane = width * height, roots = plane >> 2 * kTextureRoot, units = plane / (kUnit * kUnit);
  if (!gains_) gains_.reset(new float[size_t(plane * channels)]);
  std::vector<float> root_steps(size_t(roots * channels));
  for (int64_t i = 0; i < roots * channels; ++i) root_steps[i] = steps.of(int(i / roots), contrast[i % roots]);
  for (int size = 0; size < kTextureSizes; ++size) {
    const int log = size + kTextureLeast;
    std::vector<double> sums(channels);
    parallel_for(channels, threads, [&](int64_t channel) {
      float *gain = &gains_[size_t(channel * plane)];
      analyse_texture(gradient + channel * plane, width, height, layout, log, gain, log_size);
      each_cell_row(
          width, height, log, log_size, steps.growth(int(channel), log), &root_steps[channel * roots],
          [&](int64_t at, const CellRow &step) { sums[size_t(channel)] += double(weigh(gain + at, step, 1 << log)); });
    });
    double sum = 0;
    for (const double one : sums) sum += one;
    const int64_t moved = log_size ? int64_t(kUnit * kUnit) * std::count(log_size, log_size + units, log) : plane;
    const double unit = mean * double(moved * channels) / sum;
    if (!std::isfinite(unit)) continue;
    parallel_for(channels, threads, [&](int64_t channel) {
      const float *gain = &gains_[size_t(channel * plane)];
      float *amplitude = &sizes_[size_t(size)][size_t(channel * plane)];
      each_cell_row(width, height, log, log_size, steps.growth(int(channel), log), &root_steps[channel * roots],
                    [&](int64_t at, const CellRow &step) {
                      for (int u = 0; u < 1 << log; ++u) {
                        const float most_of_it = std::min(step[size_t(u)], std::abs(amplitude[at + u]));
                        amplitude[at + u] += most_of_it * std::clamp(float(unit) * gain[at + u], -most, most);
                      }
                    });
    });
  }
}

}  // namespace sgi
