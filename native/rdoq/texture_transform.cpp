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
  // By 1 for a hard edge on the left, plus 2 on the right.
  std::array<const float *, 4> of_edges() const {
    return {values_[0].data(), values_[1].data(), values_[2].data(), values_[3].data()};
  }
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

}  // namespace

void analyse_texture(const float *plane, int64_t width, int64_t height, int log, float *amplitudes) {
  static const Isa isa = choose_isa("auto");
  const auto &kernel = kernel_for<TextureTransformKernel>(isa);
  const Atoms &all = atoms(log);
  const int side = 1 << log;
  const std::array<const float *, 4> along = all.of_edges();
  std::vector<float> held(size_t(all.reach() * width));
  std::vector<const float *> rows(size_t(all.reach()));
  for (int64_t begin = 0; begin < height; begin += side) {
    for (int j = 0; j < all.reach(); ++j) {
      const int64_t y = begin - kOverlap + j;
      float *row = &held[j * width];
      rows[j] = y < 0 || y >= height ? nullptr : row;
      if (!rows[j]) continue;
      if (j >= 2 * kOverlap || begin == 0)
        kernel.along(plane + y * width, width, side, along.data(), row);
      else
        std::copy_n(&held[(j + side) * width], width, row);  // the cells above needed it too
    }
    kernel.down(rows.data(), width, side, all.of(begin, height), amplitudes + begin * width);
  }
}

}  // namespace sgi
