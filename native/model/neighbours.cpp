#include "model/neighbours.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "model/neighbour_kernel.hpp"

namespace sgi {
namespace {

// The square around points.
struct Extent {
  int64_t low = std::numeric_limits<int32_t>::max(), high = std::numeric_limits<int32_t>::min();

  void include(const int32_t *points, const int64_t *chosen, int64_t n) {
    for (int64_t i = 0; i < n; ++i) {
      const int64_t x = points[2 * chosen[i]], y = points[2 * chosen[i] + 1];
      low = std::min({low, x, y}), high = std::max({high, x, y});
    }
  }
};

// Points in Morton order, as seeds are, make small boxes however they are scattered; any other order is only slower.
// Places count from the corner of an extent of all points and queries.
class PointTree {
 public:
  PointTree(const int32_t *points, const int64_t *among, int64_t n, const Extent &extent)
      : all_(points), among_(among), count_(n), low_(int32_t(extent.low)),
        is_narrow_(extent.high - extent.low <= kMaxCoordinate && n <= kMaxPoints), far_(is_narrow_ ? kFar : kNowhere) {
    std::vector<Box> boxes(size_t(runs_of(n)));
    for (int64_t i = 0; i < n; ++i) boxes[size_t(i / kRun)].extend({x(i), y(i), x(i), y(i)});
    if (is_narrow_) {
      points_.assign(boxes.size() * kRun, packed(kFar, kFar));
      for (int64_t i = 0; i < n; ++i) points_[size_t(i)] = packed(x(i), y(i));
    }
    do {
      std::vector<Box> above(size_t(runs_of(int64_t(boxes.size()))));
      levels_.emplace_back(above.size() * 4 * kRun, far_);
      for (size_t i = 0; i < boxes.size(); ++i) {
        int32_t *at = levels_.back().data() + i / kRun * 4 * kRun + i % kRun;
        at[0] = boxes[i].x0, at[kRun] = boxes[i].y0, at[2 * kRun] = boxes[i].x1, at[3 * kRun] = boxes[i].y1;
        above[i / kRun].extend(boxes[i]);
      }
      boxes = std::move(above);
    } while (boxes.size() > 1);
    for (const std::vector<int32_t> &level : levels_) starts_.push_back(level.data());
    while (int64_t(1) << number_bits_ < runs_of(n) * kRun) ++number_bits_;
  }

  // Whether a kernel may search.
  bool is_narrow() const { return is_narrow_; }
  PointRuns runs() const { return {points_.data(), starts_.data(), depth(), number_bits_}; }

  int depth() const { return int(levels_.size()); }
  int64_t count() const { return count_; }
  int32_t x(int64_t point) const { return all_[2 * among_[point]] - low_; }
  int32_t y(int64_t point) const { return all_[2 * among_[point] + 1] - low_; }
  int32_t low() const { return low_; }

  uint64_t square(int64_t point, int64_t x, int64_t y) const {
    const int64_t dx = this->x(point) - x, dy = this->y(point) - y;
    return uint64_t(dx * dx) + uint64_t(dy * dy);
  }

  // The square of how far (x, y) is from box i of a node; kNoBox where there is none.
  static constexpr uint64_t kNoBox = ~uint64_t(0);
  uint64_t box_square(int level, int64_t number, int i, int64_t x, int64_t y) const {
    const int32_t *box = levels_[size_t(level)].data() + number * 4 * kRun + i;
    if (box[0] == far_) return kNoBox;
    const int64_t dx = std::max({box[0] - x, x - box[2 * kRun], int64_t(0)});
    const int64_t dy = std::max({box[kRun] - y, y - box[3 * kRun], int64_t(0)});
    return uint64_t(dx * dx) + uint64_t(dy * dy);
  }

  // Points that are near (x, y), as many as are looked for; false where there are fewer.
  bool guess(int32_t x, int32_t y, std::array<int64_t, kMaxNeighbours> &near) const {
    if (count_ < kMaxNeighbours) return false;
    int64_t number = 0;
    for (int level = depth(); level-- > 0;) {
      int best = 0;
      for (int i = 1; i < kRun; ++i)
        if (box_square(level, number, i, x, y) < box_square(level, number, best, x, y)) best = i;
      number = number * kRun + best;
    }
    const int64_t first = std::min(number * kRun, count_ - kMaxNeighbours);
    for (int j = 0; j < kMaxNeighbours; ++j) near[size_t(j)] = first + j;
    return true;
  }

 private:
  static constexpr int32_t kNowhere = std::numeric_limits<int32_t>::max();
  static constexpr int64_t kMaxPoints = int64_t(1) << 22;  // more leave no bits for distances

  struct Box {
    int32_t x0 = kNowhere, y0 = kNowhere, x1 = -kNowhere, y1 = -kNowhere;

    void extend(const Box &other) {
      x0 = std::min(x0, other.x0), y0 = std::min(y0, other.y0);
      x1 = std::max(x1, other.x1), y1 = std::max(y1, other.y1);
    }
  };

  static int64_t runs_of(int64_t count) { return (count + kRun - 1) / kRun; }

  const int32_t *all_;
  const int64_t *among_;
  int64_t count_;
  int32_t low_;
  bool is_narrow_;
  int32_t far_;  // a coordinate of what fills a last run up
  int number_bits_ = 0;
  std::vector<int32_t> points_;
  std::vector<std::vector<int32_t>> levels_;
  std::vector<const int32_t *> starts_;
};

// One query, in integers that hold any distance.
class ExactSearch {
 public:
  ExactSearch(const PointTree &tree, int k, const int32_t *query)
      : tree_(tree), x_(query[0] - tree.low()), y_(query[1] - tree.low()),
        best_(size_t(k), Found{PointTree::kNoBox, -1}) {
    visit(tree.depth() - 1, 0);
  }
  void write(int32_t *out) const {
    for (const Found &found : best_) *out++ = found.second;
  }

 private:
  using Found = std::pair<uint64_t, int32_t>;  // square of the distance, number

  void visit(int level, int64_t number) {
    std::array<std::pair<uint64_t, int>, kRun> children;
    for (int i = 0; i < kRun; ++i) children[size_t(i)] = {tree_.box_square(level, number, i, x_, y_), i};
    std::sort(children.begin(), children.end());
    for (const auto &[square, child] : children) {
      if (square == PointTree::kNoBox || square > best_.back().first) return;
      if (level)
        visit(level - 1, number * kRun + child);
      else
        look(number * kRun + child);
    }
  }

  void look(int64_t leaf) {
    for (int64_t point = leaf * kRun; point < std::min((leaf + 1) * kRun, tree_.count()); ++point) {
      const Found found{tree_.square(point, x_, y_), int32_t(point)};
      if (found >= best_.back()) continue;
      best_.back() = found;
      std::inplace_merge(best_.begin(), best_.end() - 1, best_.end());
    }
  }

  const PointTree &tree_;
  const int64_t x_, y_;
  std::vector<Found> best_;  // ascending
};

// Queries that come one after the other, which they do from neighbour to neighbour: what some have found bounds what
// the next ones can find.
class Search {
 public:
  Search(const PointTree &tree, const NeighbourKernel &kernel) : tree_(tree), runs_(tree.runs()), kernel_(kernel) {}

  // Of `count` queries, kQueries at most, their k nearest as numbers in `among`.
  void answer(const int32_t *points, const int64_t *members, int64_t count, int k, int32_t *out) {
    for (int q = 0; q < kQueries; ++q) {
      const int64_t member = members[std::min<int64_t>(q, count - 1)];
      x_[size_t(q)] = points[2 * member] - tree_.low(), y_[size_t(q)] = points[2 * member + 1] - tree_.low();
    }
    set_bounds();
    kernel_.search(runs_, x_.data(), y_.data(), keys_.data());
    for (int q = 0; q < count; ++q, out += k) {
      if (is_told(k - 1, q))
        for (int j = 0; j < k; ++j) out[j] = number(j, q);
      else
        ExactSearch(tree_, k, points + 2 * members[q]).write(out);
    }
    is_guessed_ = is_told(kMaxNeighbours - 1, kQueries - 1);
    for (int j = 0; j < kMaxNeighbours; ++j) near_[size_t(j)] = number(j, kQueries - 1);
  }

 private:
  int32_t &key(int rank, int query) { return keys_[size_t(rank * kQueries + query)]; }
  bool is_told(int rank, int query) { return key(rank, query) >> runs_.number_bits < runs_.max_square(); }
  int32_t number(int rank, int query) { return key(rank, query) & ((1 << runs_.number_bits) - 1); }

  void set_bounds() {
    keys_.fill(std::numeric_limits<int32_t>::max());
    if (!is_guessed_ && !tree_.guess(x_[0], y_[0], near_)) return;
    for (int q = 0; q < kQueries; ++q) {
      uint64_t most = 0;
      for (const int64_t point : near_) most = std::max(most, tree_.square(point, x_[size_t(q)], y_[size_t(q)]));
      if (most >= uint64_t(runs_.max_square())) continue;
      for (int j = 0; j < kMaxNeighbours; ++j) key(j, q) = int32_t(most + 1) << runs_.number_bits;
    }
  }

  const PointTree &tree_;
  const PointRuns runs_;
  const NeighbourKernel &kernel_;
  std::array<int32_t, kQueries> x_, y_;
  std::array<int32_t, kMaxNeighbours * kQueries> keys_;
  std::array<int64_t, kMaxNeighbours> near_{};  // points that bound what is next
  bool is_guessed_ = false;
};

}  // namespace

void nearest_among(const int32_t *points, const int64_t *among, int64_t n, const int64_t *members, int64_t m, int k,
                   Isa isa, int32_t *out) {
  if (n == 0) {
    std::fill(out, out + m * k, -1);
    return;
  }
  Extent extent;
  extent.include(points, among, n), extent.include(points, members, m);
  const PointTree tree(points, among, n, extent);
  if (k <= kMaxNeighbours && tree.is_narrow()) {
    Search search(tree, kernel_for<NeighbourKernel>(isa));
    for (int64_t i = 0; i < m; i += kQueries)
      search.answer(points, members + i, std::min<int64_t>(kQueries, m - i), k, out + i * k);
  } else {
    for (int64_t i = 0; i < m; ++i) ExactSearch(tree, k, points + 2 * members[i]).write(out + i * k);
  }
  for (int64_t i = 0; i < m * k; ++i)
    if (out[i] >= 0) out[i] = int32_t(among[out[i]]);
}

}  // namespace sgi
