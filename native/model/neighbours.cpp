#include "model/neighbours.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "base/thread_pool.hpp"
#include "model/neighbour_kernel.hpp"

namespace sgi {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

struct Extent {
  int64_t low = std::numeric_limits<int32_t>::max(), high = std::numeric_limits<int32_t>::min();

  void include(const int32_t *points, const int64_t *chosen, int64_t n) {
    for (int64_t i = 0; i < n; ++i) {
      const int64_t x = points[2 * chosen[i]], y = points[2 * chosen[i] + 1];
      low = std::min({low, x, y}), high = std::max({high, x, y});
    }
  }
  double most_square() const { return 2 * double(high - low) * double(high - low); }
};

// Points in Morton order, as seeds are, make small boxes however they are scattered; any other order is only slower.
class PointTree {
 public:
  PointTree(const int32_t *points, const int64_t *among, int64_t n)
      : count_(n), points_(size_t(runs_of(n)) * 2 * kRun, kNowhere) {
    std::vector<Box> boxes(size_t(runs_of(n)));
    for (int64_t i = 0; i < n; ++i) {
      const double x = points[2 * among[i]], y = points[2 * among[i] + 1];
      double *at = points_.data() + i / kRun * 2 * kRun + i % kRun;
      at[0] = x, at[kRun] = y;
      boxes[size_t(i / kRun)].extend({x, y, x, y});
    }
    do {
      std::vector<Box> above(size_t(runs_of(int64_t(boxes.size()))));
      levels_.emplace_back(above.size() * 4 * kRun, kNowhere);
      for (size_t i = 0; i < boxes.size(); ++i) {
        double *at = levels_.back().data() + i / kRun * 4 * kRun + i % kRun;
        at[0] = boxes[i].x0, at[kRun] = boxes[i].y0, at[2 * kRun] = boxes[i].x1, at[3 * kRun] = boxes[i].y1;
        above[i / kRun].extend(boxes[i]);
      }
      boxes = std::move(above);
    } while (boxes.size() > 1);
    for (const std::vector<double> &level : levels_) starts_.push_back(level.data());
    while (unit_ < n) unit_ *= 2;
  }

  PointRuns runs() const { return {points_.data(), starts_.data(), int(levels_.size()), double(unit_)}; }
  int64_t unit() const { return unit_; }

  int depth() const { return int(levels_.size()); }
  int64_t count() const { return count_; }
  // Where x of a point stands, and kRun further its y.
  const double *at(int64_t point) const { return points_.data() + point / kRun * 2 * kRun + point % kRun; }

  double key(int64_t point, double x, double y) const {
    const double dx = at(point)[0] - x, dy = at(point)[kRun] - y;
    return (dx * dx + dy * dy) * double(unit_) + double(point);
  }

  // The square of how far (x, y) is from box i of a node.
  double box_distance(int level, int64_t number, int i, double x, double y) const {
    const double *box = levels_[size_t(level)].data() + number * 4 * kRun + i;
    const double dx = std::max({box[0] - x, x - box[2 * kRun], 0.0});
    const double dy = std::max({box[kRun] - y, y - box[3 * kRun], 0.0});
    return dx * dx + dy * dy;
  }

  // Points that are near (x, y), as many as are looked for; false where there are fewer.
  bool guess(double x, double y, std::array<int64_t, kMaxNeighbours> &near) const {
    if (count_ < kMaxNeighbours) return false;
    int64_t number = 0;
    for (int level = depth(); level-- > 0;) {
      int best = 0;
      for (int i = 1; i < kRun; ++i)
        if (box_distance(level, number, i, x, y) < box_distance(level, number, best, x, y)) best = i;
      number = number * kRun + best;
    }
    const int64_t first = std::min(number * kRun, count_ - kMaxNeighbours);
    for (int j = 0; j < kMaxNeighbours; ++j) near[size_t(j)] = first + j;
    return true;
  }

 private:
  struct Box {
    double x0 = kNowhere, y0 = kNowhere, x1 = -kNowhere, y1 = -kNowhere;

    void extend(const Box &other) {
      x0 = std::min(x0, other.x0), y0 = std::min(y0, other.y0);
      x1 = std::max(x1, other.x1), y1 = std::max(y1, other.y1);
    }
  };

  static int64_t runs_of(int64_t count) { return (count + kRun - 1) / kRun; }

  int64_t count_, unit_ = 1;
  std::vector<double> points_;
  std::vector<std::vector<double>> levels_;
  std::vector<const double *> starts_;
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
      x_[size_t(q)] = points[2 * member], y_[size_t(q)] = points[2 * member + 1];
    }
    set_bounds();
    kernel_.search(runs_, x_.data(), y_.data(), keys_.data());
    for (int64_t q = 0; q < count; ++q)
      for (int j = 0; j < k; ++j) *out++ = number(j, int(q));
    for (int j = 0; j < kMaxNeighbours; ++j) near_[size_t(j)] = number(j, kQueries - 1);
    is_guessed_ = number(kMaxNeighbours - 1, kQueries - 1) >= 0;
  }

 private:
  double &key(int rank, int query) { return keys_[size_t(rank * kQueries + query)]; }

  int32_t number(int rank, int query) {
    return key(rank, query) == kNowhere ? -1 : int32_t(int64_t(key(rank, query)) & (tree_.unit() - 1));
  }

  void set_bounds() {
    keys_.fill(kNowhere);
    if (!is_guessed_ && !tree_.guess(x_[0], y_[0], near_)) return;
    for (int q = 0; q < kQueries; ++q) {
      double most = 0;
      for (const int64_t point : near_) most = std::max(most, tree_.key(point, x_[size_t(q)], y_[size_t(q)]));
      for (int j = 0; j < kMaxNeighbours; ++j) key(j, q) = most + 1;
    }
  }

  const PointTree &tree_;
  const PointRuns runs_;
  const NeighbourKernel &kernel_;
  std::array<double, kQueries> x_, y_;
  std::array<double, kMaxNeighbours * kQueries> keys_;
  std::array<int64_t, kMaxNeighbours> near_{};  // points that bound what is next
  bool is_guessed_ = false;
};

void search_runs(const PointTree &tree, const int32_t *points, const int64_t *members, int64_t m, int k, int threads,
                 Isa isa, int32_t *out) {
  constexpr int64_t kChunk = 256;
  parallel_for((m + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    Search search(tree, kernel_for<NeighbourKernel>(isa));
    const int64_t end = std::min(m, (chunk + 1) * kChunk);
    for (int64_t i = chunk * kChunk; i < end; i += kQueries)
      search.answer(points, members + i, std::min<int64_t>(kQueries, end - i), k, out + i * k);
  });
}

// The same for one query, in integers that hold any distance.
class ExactSearch {
 public:
  ExactSearch(const PointTree &tree, int k, const int32_t *query)
      : tree_(tree), x_(query[0]), y_(query[1]), best_(size_t(k), Found{~uint64_t(0), -1}) {
    visit(tree.depth() - 1, 0);
  }
  void write(int32_t *out) const {
    for (const Found &found : best_) *out++ = found.second;
  }

 private:
  using Found = std::pair<uint64_t, int32_t>;  // square of the distance, number

  void visit(int level, int64_t number) {
    std::array<std::pair<double, int>, kRun> children;
    for (int i = 0; i < kRun; ++i) children[size_t(i)] = {tree_.box_distance(level, number, i, x_, y_), i};
    std::sort(children.begin(), children.end());
    for (const auto &[distance, child] : children) {
      if (distance == kNowhere || distance * (1 - 1e-12) > double(best_.back().first)) return;
      if (level)
        visit(level - 1, number * kRun + child);
      else
        look(number * kRun + child);
    }
  }

  void look(int64_t leaf) {
    for (int64_t point = leaf * kRun; point < std::min((leaf + 1) * kRun, tree_.count()); ++point) {
      const int64_t dx = int64_t(tree_.at(point)[0]) - x_, dy = int64_t(tree_.at(point)[kRun]) - y_;
      const Found found{uint64_t(dx * dx) + uint64_t(dy * dy), int32_t(point)};
      if (found >= best_.back()) continue;
      best_.back() = found;
      std::inplace_merge(best_.begin(), best_.end() - 1, best_.end());
    }
  }

  const PointTree &tree_;
  const int32_t x_, y_;
  std::vector<Found> best_;  // ascending
};

}  // namespace

void nearest_among(const int32_t *points, const int64_t *among, int64_t n, const int64_t *members, int64_t m, int k,
                   int threads, Isa isa, int32_t *out) {
  if (n == 0) {
    std::fill(out, out + m * k, -1);
    return;
  }
  const PointTree tree(points, among, n);
  Extent extent;
  extent.include(points, among, n), extent.include(points, members, m);
  if (k <= kMaxNeighbours && extent.most_square() < 0x1p53 / double(tree.unit()) - 2)
    search_runs(tree, points, members, m, k, threads, isa, out);
  else
    parallel_for(m, threads, [&](int64_t i) { ExactSearch(tree, k, points + 2 * members[i]).write(out + i * k); });
  for (int64_t i = 0; i < m * k; ++i)
    if (out[i] >= 0) out[i] = int32_t(among[out[i]]);
}

}  // namespace sgi
