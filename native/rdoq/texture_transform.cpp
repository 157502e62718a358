#include "rdoq/texture_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/isa.hpp"
#include "model/constants.hpp"
#include "model/texture_axis.hpp"
#include "rdoq/texture_transform_kernel.hpp"

namespace sgi {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kOverlap = kTextureOverlap;

// Basis functions at pixel centres [n + 2 overlap, n], for cells with and without hard edges, and for separate ones.
class Atoms {
 public:
  explicit Atoms(int log) : side_(1 << log) {
    for (int hard = 0; hard < 4; ++hard) add(values_[hard], hard & 1, hard & 2, 0.5);
    add(separate_, true, true, 0);
    for (int j = 0; j < reach(); ++j) separate_[j * side_] *= float(std::sqrt(0.5));
  }
  int reach() const { return side_ + 2 * kOverlap; }
  // Those of the cell that begins at pixel `begin`, where the last one ends at `end`.
  const float *of(int64_t begin, int64_t end, bool separate) const {
    return (separate ? separate_ : values_[(begin == 0) | (begin + side_ == end ? 2 : 0)]).data();
  }

 private:
  void add(std::vector<float> &values, bool hard_low, bool hard_high, double phase) const {
    for (int j = 0; j < reach(); ++j) {
      const double t = j - kOverlap + 0.5;
      const double window = texture_edge(t, hard_low) * texture_edge(side_ - t, hard_high);
      for (int k = 0; k < side_; ++k)
        values.push_back(float(std::sqrt(2.0 / side_) * window * std::cos(kPi * (k + phase) * t / side_)));
    }
  }

  int side_;
  std::array<std::vector<float>, 4> values_;
  std::vector<float> separate_;
};

const Atoms &atoms(int log) {
  static const std::array<Atoms, kTextureSizes> all{Atoms(3), Atoms(4), Atoms(5)};
  return all[log - kTextureLeast];
}

// The square of pixels that begins at (x, y), 0 beyond the plane.
void copy_around(const float *plane, int64_t width, int64_t height, int64_t x, int64_t y, int64_t side, float *out) {
  const int64_t begin = std::max<int64_t>(-x, 0), end = std::min(side, width - x);
  for (int64_t j = 0; j < side; ++j, out += side) {
    std::fill_n(out, side, 0.0f);
    if (y + j >= 0 && y + j < height)
      std::copy(plane + (y + j) * width + x + begin, plane + (y + j) * width + x + end, out + begin);
  }
}

}  // namespace

void analyse_texture(const float *plane, int64_t width, int64_t height, const TextureLayout &layout, int log,
                     float *amplitudes, const uint8_t *log_size) {
  static const Isa isa = choose_isa("auto");
  const auto &kernel = kernel_for<TextureTransformKernel>(isa);
  const Atoms &all = atoms(log);
  const int side = 1 << log, reach = all.reach();
  const int64_t right = texture_end(layout.width), bottom = texture_end(layout.height);
  std::vector<float> pixels(size_t(reach * reach));
  for (int64_t y = 0; y < height; y += side)
    for (int64_t x = 0; x < width; x += side) {
      float *out = amplitudes + y * width + x;
      if (!is_of_size(log_size, width, x, y, log)) continue;
      copy_around(plane, width, height, x - kOverlap, y - kOverlap, reach, pixels.data());
      kernel.transform(pixels.data(), side, all.of(x, right, layout.separate), all.of(y, bottom, layout.separate), out,
                       width);
    }
}

}  // namespace sgi
