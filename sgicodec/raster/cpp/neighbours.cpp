#include "neighbours.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "thread_pool.hpp"

namespace sgi {
namespace {

struct Box {
  int32_t lo[2], hi[2];

  int64_t squared_distance(const int32_t *p) const {
    int64_t sum = 0;
    for (int d = 0; d < 2; ++d) {
      const int64_t out = std::max<int64_t>({int64_t(lo[d]) - p[d], int64_t(p[d]) - hi[d], 0});
      sum += out * out;
    }
    return sum;
  }
};

// The k nearest so far, nearest first, ties to the lower index; none farther than `limit`.
class Best {
 public:
  Best(int k, const int32_t *points) : k_(k), points_(points), found_(k + 1) {}

  // Starts another query. What the last one found bounds what this one can find: queries come in an order that goes from
  // neighbour to neighbour.
  void start(const int32_t *query) {
    limit_ = kAnywhere;
    if (count_ == k_) {
      limit_ = 0;
      for (int j = 0; j < k_; ++j) limit_ = std::max(limit_, distance(query, found_[j].second));
    }
    count_ = 0;
  }
  bool wants(int64_t distance) const { return distance <= limit_; }
  void add(const int32_t *query, int32_t index) {
    const std::pair<int64_t, int32_t> candidate{distance(query, index), index};
    if (candidate.first > limit_) return;
    int at = count_;
    for (; at > 0 && candidate < found_[at - 1]; --at) found_[at] = found_[at - 1];
    found_[at] = candidate;
    count_ = std::min(count_ + 1, k_);
    if (count_ == k_) limit_ = std::min(limit_, found_[k_ - 1].first);
  }
  void write(int32_t *out) const {
    for (int j = 0; j < k_; ++j) out[j] = j < count_ ? found_[j].second : -1;
  }

 private:
  static constexpr int64_t kAnywhere = INT64_MAX;

  int64_t distance(const int32_t *query, int32_t index) const {
    const int64_t dx = int64_t(points_[2 * int64_t(index)]) - query[0];
    const int64_t dy = int64_t(points_[2 * int64_t(index) + 1]) - query[1];
    return dx * dx + dy * dy;
  }

  int k_, count_ = 0;
  const int32_t *points_;
  std::vector<std::pair<int64_t, int32_t>> found_;
  int64_t limit_ = kAnywhere;
};

// Boxes around runs of points, and around pairs of boxes up to one around all: node i has the children 2i and 2i + 1.
// Points in Morton order, as seeds are, make small boxes however they are scattered; any other order is only slower.
class Tree {
 public:
  Tree(const int32_t *points, int64_t n) : n_(n) {
    while (leaves_ * kLeaf < n) leaves_ *= 2;
    boxes_.assign(2 * leaves_, Box{{INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN}});
    for (int64_t i = 0; i < n; ++i) extend(boxes_[leaves_ + i / kLeaf], points + 2 * i, points + 2 * i);
    for (int64_t node = leaves_ - 1; node > 0; --node)
      for (int64_t child : {2 * node, 2 * node + 1}) extend(boxes_[node], boxes_[child].lo, boxes_[child].hi);
  }

  // Adds to `best` whatever belongs there.
  void search(const int32_t *query, Best &best) const { visit(1, boxes_[1].squared_distance(query), query, best); }

 private:
  static constexpr int64_t kLeaf = 8;

  static void extend(Box &box, const int32_t *lo, const int32_t *hi) {
    for (int d = 0; d < 2; ++d) {
      box.lo[d] = std::min(box.lo[d], lo[d]);
      box.hi[d] = std::max(box.hi[d], hi[d]);
    }
  }

  // The boxes behind the last point are empty and lie nowhere.
  bool empty(int64_t node) const { return boxes_[node].lo[0] > boxes_[node].hi[0]; }

  void visit(int64_t node, int64_t distance, const int32_t *query, Best &best) const {
    if (!best.wants(distance)) return;
    if (node >= leaves_) {
      const int64_t begin = (node - leaves_) * kLeaf, end = std::min(n_, begin + kLeaf);
      for (int64_t i = begin; i < end; ++i) best.add(query, int32_t(i));
      return;
    }
    int64_t near = 2 * node, far = near + 1;
    if (empty(far)) return visit(near, boxes_[near].squared_distance(query), query, best);
    int64_t to_near = boxes_[near].squared_distance(query), to_far = boxes_[far].squared_distance(query);
    if (to_far < to_near) {
      std::swap(near, far);
      std::swap(to_near, to_far);
    }
    visit(near, to_near, query, best);
    visit(far, to_far, query, best);
  }

  int64_t n_, leaves_ = 1;
  std::vector<Box> boxes_;
};

// Of each of queries [m, 2] its k nearest of points [n, 2].
void nearest_points(const int32_t *points, int64_t n, const int32_t *queries, int64_t m, int k, int threads,
                    int32_t *out) {
  if (n == 0) {
    std::fill(out, out + m * k, -1);
    return;
  }
  const Tree tree(points, n);
  constexpr int64_t kChunk = 256;
  parallel_for((m + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    Best best(k, points);
    for (int64_t i = chunk * kChunk; i < std::min(m, (chunk + 1) * kChunk); ++i) {
      best.start(queries + 2 * i);
      tree.search(queries + 2 * i, best);
      best.write(out + i * k);
    }
  });
}

}  // namespace

void nearest_among(const int32_t *points, const int64_t *among, int64_t n, const int64_t *members, int64_t m, int k,
                   int threads, int32_t *out) {
  const auto gathered = [&](const int64_t *indices, int64_t count) {
    std::vector<int32_t> chosen(2 * count);
    for (int64_t i = 0; i < count; ++i) std::copy_n(points + 2 * indices[i], 2, chosen.begin() + 2 * i);
    return chosen;
  };
  nearest_points(gathered(among, n).data(), n, gathered(members, m).data(), m, k, threads, out);
  for (int64_t i = 0; i < m * k; ++i)
    if (out[i] >= 0) out[i] = int32_t(among[out[i]]);
}

}  // namespace sgi
