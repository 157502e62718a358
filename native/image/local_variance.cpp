#include "image/local_variance.hpp"

#include <algorithm>
#include <vector>

namespace sgi {
namespace {

// Sums of the samples of a window, and of their squares.
struct Sums {
  double one = 0, two = 0;
};

// Sums over a window's rows in each column, which move down with it.
class ColumnSums {
 public:
  ColumnSums(const double *plane, int64_t width) : plane_(plane), width_(width), sums_(width) {}

  void add(int64_t y, double sign) {
    const double *row = plane_ + y * width_;
    for (int64_t x = 0; x < width_; ++x) {
      sums_[x].one += sign * row[x];
      sums_[x].two += sign * row[x] * row[x];
    }
  }

  // Variances of the windows around a row of pixels that have `height` rows.
  void write(int radius, int64_t height, double *variance) const {
    Sums sum;
    const auto move = [&](int64_t x, double sign) {
      sum.one += sign * sums_[x].one;
      sum.two += sign * sums_[x].two;
    };
    for (int64_t x = 0; x < std::min<int64_t>(radius, width_); ++x) move(x, 1);
    for (int64_t x = 0; x < width_; ++x) {
      if (x + radius < width_) move(x + radius, 1);
      if (x > radius) move(x - radius - 1, -1);
      const int64_t width = std::min(x + radius + 1, width_) - std::max<int64_t>(x - radius, 0);
      const double share = 1.0 / double(width * height), mean = share * sum.one;
      variance[x] = std::max(share * sum.two - mean * mean, 0.0);
    }
  }

 private:
  const double *plane_;
  int64_t width_;
  std::vector<Sums> sums_;
};

}  // namespace

void local_variance(const double *plane, int64_t height, int64_t width, int radius, double *variance) {
  ColumnSums sums(plane, width);
  for (int64_t y = 0, begin = 0, end = 0; y < height; ++y) {
    for (; end < std::min(y + radius + 1, height); ++end) sums.add(end, 1);
    for (; begin < y - radius; ++begin) sums.add(begin, -1);
    sums.write(radius, end - begin, variance + y * width);
  }
}

}  // namespace sgi
