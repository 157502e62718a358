#include "rdoq/base_search.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "bitstream/base_planes.hpp"

namespace sgi {
namespace {

constexpr double kMaxSaved = 40.0;  // bits that a move could save, generously

class BaseSearch {
 public:
  BaseSearch(const BasePlanes &planes, const BaseFootprint &footprint)
      : p_(planes), f_(footprint), error_(planes.channels * planes.rows * planes.columns) {
    for (int64_t c = 0; c < p_.channels; ++c)
      for (int64_t y = 0; y < p_.rows; ++y)
        for (int64_t x = 0; x < p_.columns; ++x) error_[at(c, y, x)] = error(c, y, x);
  }

  bool move(int64_t c, int64_t y, int64_t x, double lmbda) {
    const double pull = f_.step * f_.pull[at(c, y, x)];
    const double square = f_.gram ? f_.step * f_.step * *f_.own_gram(y, x, p_.columns)
                                  : f_.step * f_.step * f_.down[y * p_.rows + y] * f_.across[x * p_.columns + x];
    int64_t best = 0;
    double least = -1e-9 * lmbda;
    for (const int64_t by : {int64_t(-1), int64_t(1), int64_t(std::llrint(pull / square))}) {
      const double change = by * (by * square - 2 * pull);
      if (change > lmbda * kMaxSaved) continue;
      const double cost = change + lmbda * bits_by(c, y, x, by);
      if (cost < least) {
        least = cost;
        best = by;
      }
    }
    if (best) take(c, y, x, best);
    return best != 0;
  }

 private:
  int64_t at(int64_t c, int64_t y, int64_t x) const { return (c * p_.rows + y) * p_.columns + x; }

  int64_t error(int64_t c, int64_t y, int64_t x) const {
    const int64_t *plane = p_.values + c * p_.rows * p_.columns;
    return plane[y * p_.columns + x] - base_prediction(plane, p_.columns, x, y, p_.predictor[c]);
  }

  // Bits of an element of channel c, whose own error is `own` and of whose references `changed` has the error `theirs`.
  double bits(int64_t c, int64_t own, int64_t changed, int64_t theirs, int64_t place) const {
    int64_t mixed = 4;
    for (int64_t r = 0; r < c; ++r)
      mixed += p_.weights[c * p_.channels + r] * (r == changed ? theirs : error_[r * p_.rows * p_.columns + place]);
    return p_.tables.of(own - (mixed >> 3), p_.table[c]);
  }

  template <class Visit>
  void for_each_affected(int64_t y, int64_t x, Visit visit) const {
    for (int64_t v = y; v <= std::min(y + 1, p_.rows - 1); ++v)
      for (int64_t u = x; u <= std::min(x + 1, p_.columns - 1); ++u) visit(v, u);
  }

  // How the bits change when an element moves.
  double bits_by(int64_t c, int64_t y, int64_t x, int64_t by) {
    double change = 0;
    p_.values[at(c, y, x)] += by;
    for_each_affected(y, x, [&](int64_t v, int64_t u) {
      const int64_t place = v * p_.columns + u, old = error_[at(c, v, u)], fresh = error(c, v, u);
      if (fresh == old) return;
      change += bits(c, fresh, -1, 0, place) - bits(c, old, -1, 0, place);
      for (int64_t d = c + 1; d < p_.channels; ++d) {
        if (!p_.weights[d * p_.channels + c]) continue;
        const int64_t own = error_[at(d, v, u)];
        change += bits(d, own, c, fresh, place) - bits(d, own, c, old, place);
      }
    });
    p_.values[at(c, y, x)] -= by;
    return change;
  }

  void take(int64_t c, int64_t y, int64_t x, int64_t by) {
    p_.values[at(c, y, x)] += by;
    for_each_affected(y, x, [&](int64_t v, int64_t u) { error_[at(c, v, u)] = error(c, v, u); });
    for (int64_t v = std::max<int64_t>(0, y - kBaseReach); v <= std::min(p_.rows - 1, y + kBaseReach); ++v)
      for (int64_t u = std::max<int64_t>(0, x - kBaseReach); u <= std::min(p_.columns - 1, x + kBaseReach); ++u)
        f_.pull[at(c, v, u)] -=
            f_.gram ? by * f_.step * f_.own_gram(y, x, p_.columns)[(v - y) * (2 * kBaseReach + 1) + u - x]
                    : by * f_.step * f_.down[y * p_.rows + v] * f_.across[x * p_.columns + u];
  }

  const BasePlanes &p_;
  const BaseFootprint &f_;
  std::vector<int64_t> error_;
};

}  // namespace

int64_t search_base(const BasePlanes &planes, const BaseFootprint &footprint, double lmbda, int passes) {
  BaseSearch search(planes, footprint);
  int64_t moves = 0;
  for (int pass = 0; pass < passes; ++pass)
    for (int64_t c = 0; c < planes.channels; ++c)
      for (int64_t y = 0; y < planes.rows; ++y)
        for (int64_t x = 0; x < planes.columns; ++x) moves += search.move(c, y, x, lmbda);
  return moves;
}

}  // namespace sgi
