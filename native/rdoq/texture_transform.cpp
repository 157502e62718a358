#include "rdoq/texture_transform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "model/constants.hpp"
#include "model/texture_axis.hpp"

namespace sgi {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kOverlap = kTextureOverlap, kMaxReach = (1 << kTextureRoot) + 2 * kOverlap;

// Basis functions at pixel centres [n + 2 overlap, n], for cells with and without hard edges.
class Atoms {
 public:
  explicit Atoms(int log) : side_(1 << log) {
    for (int hard = 0; hard < 4; ++hard)
      for (int j = 0; j < reach(); ++j) {
        const double t = j - kOverlap + 0.5;
        const double window = texture_edge(t, hard & 1) * texture_edge(side_ - t, hard & 2);
        for (int k = 0; k < side_; ++k)
          values_[hard].push_back(float(std::sqrt(2.0 / side_) * window * std::cos(kPi * (k + 0.5) * t / side_)));
      }
  }
  int reach() const { return side_ + 2 * kOverlap; }
  // Those of the cell that begins at pixel `begin` of `length`.
  const float *of(int64_t begin, int64_t length) const {
    return values_[(begin == 0) | (begin + side_ == length ? 2 : 0)].data();
  }

 private:
  int side_;
  std::array<std::vector<float>, 4> values_;
};

const Atoms &atoms(int log) {
  static const std::array<Atoms, kTextureSizes> all{Atoms(3), Atoms(4), Atoms(5)};
  return all[log - kTextureLeast];
}

void analyse_row(const float *row, int64_t width, int log, float *out) {
  const Atoms &all = atoms(log);
  const int side = 1 << log;
  for (int64_t begin = 0; begin < width; begin += side) {
    const float *values = all.of(begin, width);
    std::array<float, 1 << kTextureRoot> sums{};
    for (int j = 0; j < all.reach(); ++j) {
      const int64_t x = begin - kOverlap + j;
      if (x < 0 || x >= width) continue;
      for (int k = 0; k < side; ++k) sums[k] += row[x] * values[j * side + k];
    }
    std::copy_n(sums.data(), side, out + begin);
  }
}

}  // namespace

void analyse_texture(const float *plane, int64_t width, int64_t height, int log, float *amplitudes) {
  const Atoms &all = atoms(log);
  const int side = 1 << log;
  std::vector<float> rows(size_t(kMaxReach * width));
  for (int64_t begin = 0; begin < height; begin += side) {
    const float *values = all.of(begin, height);
    std::fill_n(amplitudes + begin * width, side * width, 0.0f);
    for (int j = 0; j < all.reach(); ++j) {
      const int64_t y = begin - kOverlap + j;
      if (y < 0 || y >= height) continue;
      float *row = &rows[j * width];
      if (j >= 2 * kOverlap || begin == 0)
        analyse_row(plane + y * width, width, log, row);
      else
        std::copy_n(&rows[(j + side) * width], width, row);  // the cells above needed it too
      for (int k = 0; k < side; ++k)
        for (int64_t x = 0; x < width; ++x) amplitudes[(begin + k) * width + x] += values[j * side + k] * row[x];
    }
  }
}

}  // namespace sgi
