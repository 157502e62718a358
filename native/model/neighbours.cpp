#include "model/neighbours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "base/thread_pool.hpp"

#ifdef SGI_X86
#include <immintrin.h>
#endif

namespace sgi {
namespace {

constexpr int kLanes = 16;
constexpr float kNowhere = std::numeric_limits<float>::quiet_NaN();  // neither near nor far
constexpr float kAnywhere = std::numeric_limits<float>::infinity();

using Lanes = std::array<float, kLanes>;

// The small one is quicker and holds 2^28 points with coordinates up to 2^16 either way.
using SmallKey = uint64_t;
using LargeKey = unsigned __int128;
constexpr int kSmallIndexBits = 28;
constexpr int64_t kSmallCoordinate = 1 << 16;

// Which lanes are at most `limit`, as bits.
uint32_t at_most(const Lanes &lanes, float limit) {
  uint32_t mask = 0;
#ifdef SGI_X86
  const __m128 most = _mm_set1_ps(limit);
  for (int i = 0; i < kLanes; i += 4)
    mask |= uint32_t(_mm_movemask_ps(_mm_cmple_ps(_mm_loadu_ps(lanes.data() + i), most))) << i;
#else
  for (int i = 0; i < kLanes; ++i) mask |= uint32_t(lanes[i] <= limit) << i;
#endif
  return mask;
}

// The k nearest so far: squared distances, exact, and below them in the same integer the points' indices, so that a
// smaller one is nearer or, as near, has the lower index. Key: an integer that holds both.
template <class Key>
class Best {
 public:
  // error: what a coordinate may lose as a float.
  Best(int k, const int32_t *points, float error) : points_(points), error_(error), keys_(size_t(k), kNone) {}

  // Starts another query. What the last one found bounds what this one can find: queries come in an order that goes
  // from neighbour to neighbour.
  void start(const int32_t *query) {
    query_ = query;
    Key bound = keys_.back() == kNone ? kNone : 0;
    if (bound != kNone)
      for (const Key key : keys_) bound = std::max(bound, key_of(index_of(key)) | kIndex);
    std::fill(keys_.begin(), keys_.end(), bound);
    measure();
  }
  const int32_t *query() const { return query_; }
  // Squared distances in floats of all that may be wanted are at most this.
  float limit() const { return limit_; }
  void add(int64_t index) {
    const Key key = key_of(index);
    for (size_t j = keys_.size() - 1; j > 0; --j) keys_[j] = std::min(std::max(key, keys_[j - 1]), keys_[j]);
    keys_[0] = std::min(keys_[0], key);
  }
  // Brings the limit up to date after points were added.
  void measure() {
    if (keys_.back() == kNone) {
      limit_ = kAnywhere;
      return;
    }
    const float distance = std::sqrt(float(int64_t(keys_.back() >> kIndexBits))) + error_;
    limit_ = distance * distance * 1.00001f;  // roundings are below 1e-6
  }
  void write(int32_t *out) const {
    for (const Key key : keys_) *out++ = key == kNone ? -1 : index_of(key);
  }

 private:
  static constexpr int kIndexBits = sizeof(Key) == sizeof(SmallKey) ? kSmallIndexBits : 32;
  static constexpr Key kNone = ~Key(0), kIndex = (Key(1) << kIndexBits) - 1;

  static int32_t index_of(Key key) { return int32_t(key & kIndex); }
  Key key_of(int64_t index) const {
    const int64_t dx = int64_t(points_[2 * index]) - query_[0], dy = int64_t(points_[2 * index + 1]) - query_[1];
    return Key(dx * dx + dy * dy) << kIndexBits | Key(index);
  }

  const int32_t *points_, *query_ = nullptr;
  float error_, limit_ = kAnywhere;
  std::vector<Key> keys_;  // ascending; at first bounds that no point has
};

// Boxes around runs of points, and around runs of boxes up to one node for all. Points in Morton order, as seeds are,
// make small boxes however they are scattered; any other order is only slower.
class Tree {
 public:
  Tree(const int32_t *points, int64_t n) : leaves_(size_t((n + kLanes - 1) / kLanes)) {
    std::vector<Box> boxes(leaves_.size());
    for (int64_t i = 0; i < n; ++i) {
      const auto x = float(points[2 * i]), y = float(points[2 * i + 1]);
      Leaf &leaf = leaves_[size_t(i / kLanes)];
      leaf.x[size_t(i % kLanes)] = x, leaf.y[size_t(i % kLanes)] = y;
      boxes[size_t(i / kLanes)].extend({x, y, x, y});
    }
    do {
      std::vector<Box> above((boxes.size() + kLanes - 1) / kLanes);
      levels_.emplace_back(above.size());
      for (size_t i = 0; i < boxes.size(); ++i) {
        levels_.back()[i / kLanes].set(i % kLanes, boxes[i]);
        above[i / kLanes].extend(boxes[i]);
      }
      boxes = std::move(above);
    } while (boxes.size() > 1);
  }

  // Adds to `best` whatever belongs there.
  template <class Key>
  void search(Best<Key> &best) const {
    visit(levels_.size() - 1, 0, float(best.query()[0]), float(best.query()[1]), best);
  }

 private:
  struct Box {
    float x0 = kAnywhere, y0 = kAnywhere, x1 = -kAnywhere, y1 = -kAnywhere;

    void extend(const Box &other) {
      x0 = std::min(x0, other.x0), y0 = std::min(y0, other.y0);
      x1 = std::max(x1, other.x1), y1 = std::max(y1, other.y1);
    }
  };

  static Lanes nowhere() {
    Lanes lanes;
    lanes.fill(kNowhere);
    return lanes;
  }

  struct Node {  // boxes of its children
    Lanes x0 = nowhere(), y0 = nowhere(), x1 = nowhere(), y1 = nowhere();

    void set(size_t lane, const Box &box) {
      x0[lane] = box.x0, y0[lane] = box.y0, x1[lane] = box.x1, y1[lane] = box.y1;
    }
  };

  struct Leaf {
    Lanes x = nowhere(), y = nowhere();
  };

  // levels_[0] holds the nodes above leaves, the last one the node of all.
  template <class Key>
  void visit(size_t level, size_t number, float x, float y, Best<Key> &best) const {
    const Node &node = levels_[level][number];
    Lanes distance;
    for (int i = 0; i < kLanes; ++i) {
      const float dx = std::max(std::max(node.x0[i] - x, x - node.x1[i]), 0.0f);
      const float dy = std::max(std::max(node.y0[i] - y, y - node.y1[i]), 0.0f);
      distance[i] = dx * dx + dy * dy;
    }
    std::array<uint32_t, kLanes> order;  // a distance's bits are ordered as it is; the last ones make room for the lane
    size_t count = 0;
    for (uint32_t mask = at_most(distance, best.limit()); mask; mask &= mask - 1) {
      const auto lane = uint32_t(__builtin_ctz(mask));
      uint32_t key;
      std::memcpy(&key, &distance[lane], sizeof key);
      key = (key & ~uint32_t(kLanes - 1)) | lane;
      size_t at = count++;
      for (; at > 0 && order[at - 1] > key; --at) order[at] = order[at - 1];
      order[at] = key;
    }
    for (size_t i = 0; i < count; ++i) {
      const size_t lane = order[i] & (kLanes - 1);
      if (distance[lane] > best.limit()) continue;
      if (level)
        visit(level - 1, number * kLanes + lane, x, y, best);
      else
        look(number * kLanes + lane, x, y, best);
    }
  }

  template <class Key>
  void look(size_t number, float x, float y, Best<Key> &best) const {
    const Leaf &leaf = leaves_[number];
    Lanes distance;
    for (int i = 0; i < kLanes; ++i) {
      const float dx = leaf.x[i] - x, dy = leaf.y[i] - y;
      distance[i] = dx * dx + dy * dy;
    }
    for (uint32_t mask = at_most(distance, best.limit()); mask; mask &= mask - 1)
      best.add(int64_t(number) * kLanes + __builtin_ctz(mask));
    best.measure();
  }

  std::vector<Leaf> leaves_;
  std::vector<std::vector<Node>> levels_;
};

int64_t largest(const int32_t *coordinates, int64_t n) {
  int64_t most = 0;
  for (int64_t i = 0; i < n; ++i) most = std::max(most, std::abs(int64_t(coordinates[i])));
  return most;
}

template <class Key>
void search_all(const int32_t *points, int64_t n, const int32_t *queries, int64_t m, int k, float error, int threads,
                int32_t *out) {
  const Tree tree(points, n);
  constexpr int64_t kChunk = 256;
  parallel_for((m + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    Best<Key> best(k, points, error);
    for (int64_t i = chunk * kChunk; i < std::min(m, (chunk + 1) * kChunk); ++i) {
      best.start(queries + 2 * i);
      tree.search(best);
      best.write(out + i * k);
    }
  });
}

// Of each of queries [m, 2] its k nearest of points [n, 2].
void nearest_points(const int32_t *points, int64_t n, const int32_t *queries, int64_t m, int k, int threads,
                    int32_t *out) {
  if (n == 0) {
    std::fill(out, out + m * k, -1);
    return;
  }
  const int64_t most = std::max(largest(points, 2 * n), largest(queries, 2 * m));
  const float error = most <= 1 << 24 ? 0.0f : 8 * float(most) * 0x1p-24f;  // four roundings, and to spare
  const bool small = most <= kSmallCoordinate && n < int64_t(1) << kSmallIndexBits;
  (small ? search_all<SmallKey> : search_all<LargeKey>)(points, n, queries, m, k, error, threads, out);
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
