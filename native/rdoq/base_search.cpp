#include "rdoq/base_search.hpp"

#include <algorithm>
#include <cmath>

#include "bitstream/base_planes.hpp"

namespace sgi {
namespace {

constexpr double kMaxSaved = 40.0;  // bits that a move could save, generously
constexpr int64_t kBaseReach = 3;   // cells farther apart share no pixel

class BaseSearch {
 public:
  BaseSearch(const BasePlanes &planes, const BaseFootprint &footprint) : p_(planes), f_(footprint) {}

  bool move(int64_t c, int64_t y, int64_t x, double lmbda) {
    const double pull = f_.step * f_.pull[at(c, y, x)];
    const double square = f_.step * f_.step * f_.down[y * p_.rows + y] * f_.across[x * p_.columns + x];
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

  // Of an element and those that are predicted from it.
  double bits_around(int64_t c, int64_t y, int64_t x) const {
    const int64_t *plane = p_.values + at(c, 0, 0);
    double bits = 0;
    for (int64_t v = y; v <= std::min(y + 1, p_.rows - 1); ++v)
      for (int64_t u = x; u <= std::min(x + 1, p_.columns - 1); ++u)
        bits += p_.tables.of(plane[v * p_.columns + u] - base_prediction(plane, p_.columns, u, v), p_.table[c]);
    return bits;
  }

  // How the bits change when an element moves.
  double bits_by(int64_t c, int64_t y, int64_t x, int64_t by) {
    const double before = bits_around(c, y, x);
    p_.values[at(c, y, x)] += by;
    const double after = bits_around(c, y, x);
    p_.values[at(c, y, x)] -= by;
    return after - before;
  }

  void take(int64_t c, int64_t y, int64_t x, int64_t by) {
    p_.values[at(c, y, x)] += by;
    for (int64_t v = std::max<int64_t>(0, y - kBaseReach); v <= std::min(p_.rows - 1, y + kBaseReach); ++v)
      for (int64_t u = std::max<int64_t>(0, x - kBaseReach); u <= std::min(p_.columns - 1, x + kBaseReach); ++u)
        f_.pull[at(c, v, u)] -= by * f_.step * f_.down[y * p_.rows + v] * f_.across[x * p_.columns + u];
  }

  const BasePlanes &p_;
  const BaseFootprint &f_;
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
