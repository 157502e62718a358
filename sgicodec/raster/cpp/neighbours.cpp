#include "neighbours.hpp"

#include <algorithm>
#include <numeric>
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

// The k nearest so far, nearest first, ties to the lower index.
class Best {
 public:
  explicit Best(int k) : k_(k) { found_.reserve(k + 1); }

  void clear() { found_.clear(); }
  bool wants(int64_t distance) const { return static_cast<int>(found_.size()) < k_ || distance <= found_.back().first; }
  void add(int64_t distance, int32_t index) {
    const std::pair<int64_t, int32_t> candidate{distance, index};
    found_.insert(std::upper_bound(found_.begin(), found_.end(), candidate), candidate);
    if (static_cast<int>(found_.size()) > k_) found_.pop_back();
  }
  void write(int32_t *out) const {
    for (int j = 0; j < k_; ++j) out[j] = j < static_cast<int>(found_.size()) ? found_[j].second : -1;
  }

 private:
  int k_;
  std::vector<std::pair<int64_t, int32_t>> found_;
};

// A k-d tree: however a stream scatters its seeds, a search stays short (buckets of one size would not).
class Tree {
 public:
  Tree(const int32_t *points, int64_t n) : points_(points), order_(n) {
    std::iota(order_.begin(), order_.end(), 0);
    nodes_.reserve(4 * (n / kLeaf + 1));
    build(0, n);
  }

  void search(const int32_t *query, Best &best) const { visit(0, nodes_[0].box.squared_distance(query), query, best); }

 private:
  static constexpr int64_t kLeaf = 12;

  struct Node {
    Box box;
    int32_t begin, end;   // of its points in order_
    int32_t right;        // its second child, 0 for a leaf; the first one follows it
  };

  const int32_t *at(int32_t index) const { return points_ + 2 * int64_t(index); }

  int32_t build(int64_t begin, int64_t end) {
    const auto number = static_cast<int32_t>(nodes_.size());
    const int32_t *first = at(order_[begin]);
    Node node{{{first[0], first[1]}, {first[0], first[1]}}, int32_t(begin), int32_t(end), 0};
    for (int64_t i = begin; i < end; ++i)
      for (int d = 0; d < 2; ++d) {
        node.box.lo[d] = std::min(node.box.lo[d], at(order_[i])[d]);
        node.box.hi[d] = std::max(node.box.hi[d], at(order_[i])[d]);
      }
    nodes_.push_back(node);
    if (end - begin > kLeaf) {
      const Box &box = node.box;
      const int axis = int64_t(box.hi[0]) - box.lo[0] < int64_t(box.hi[1]) - box.lo[1];
      const auto before = [&](int32_t a, int32_t b) { return at(a)[axis] < at(b)[axis]; };
      const int64_t middle = begin + (end - begin) / 2;
      std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, before);
      build(begin, middle);
      nodes_[number].right = build(middle, end);
    }
    return number;
  }

  void visit(int32_t number, int64_t distance, const int32_t *query, Best &best) const {
    if (!best.wants(distance)) return;
    const Node &node = nodes_[number];
    if (node.right == 0) {
      for (int32_t i = node.begin; i < node.end; ++i) {
        const int32_t *p = at(order_[i]);
        const int64_t dx = int64_t(p[0]) - query[0], dy = int64_t(p[1]) - query[1];
        if (best.wants(dx * dx + dy * dy)) best.add(dx * dx + dy * dy, order_[i]);
      }
      return;
    }
    int32_t near = number + 1, far = node.right;
    int64_t to_near = nodes_[near].box.squared_distance(query), to_far = nodes_[far].box.squared_distance(query);
    if (to_far < to_near) {
      std::swap(near, far);
      std::swap(to_near, to_far);
    }
    visit(near, to_near, query, best);
    visit(far, to_far, query, best);
  }

  const int32_t *points_;
  std::vector<int32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace

void nearest_neighbours(const int32_t *points, int64_t n, const int32_t *queries, int64_t m, int k, int threads,
                        int32_t *out) {
  if (n == 0) {
    std::fill(out, out + m * k, -1);
    return;
  }
  const Tree tree(points, n);
  constexpr int64_t kChunk = 256;
  parallel_for((m + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    Best best(k);
    for (int64_t i = chunk * kChunk; i < std::min(m, (chunk + 1) * kChunk); ++i) {
      best.clear();
      tree.search(queries + 2 * i, best);
      best.write(out + i * k);
    }
  });
}

}  // namespace sgi
