#include "neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "thread_pool.hpp"

namespace sgi {
namespace {

// Points bucketed by square cells of a size that puts about two in each.
class Grid {
 public:
  Grid(const int32_t *points, int64_t n) : points_(points) {
    int32_t hi[2];
    for (int d = 0; d < 2; ++d) {
      lo_[d] = std::numeric_limits<int32_t>::max();
      hi[d] = std::numeric_limits<int32_t>::min();
      for (int64_t i = 0; i < n; ++i) {
        lo_[d] = std::min(lo_[d], points[2 * i + d]);
        hi[d] = std::max(hi[d], points[2 * i + d]);
      }
    }
    const double width = double(hi[0]) - lo_[0] + 1, height = double(hi[1]) - lo_[1] + 1;
    side_ = std::max<int64_t>({1, static_cast<int64_t>(std::sqrt(2.0 * width * height / double(n))),
                               static_cast<int64_t>(std::max(width, height) / double(n))});
    nx_ = static_cast<int64_t>(width) / side_ + 1;
    ny_ = static_cast<int64_t>(height) / side_ + 1;
    start_.assign(nx_ * ny_ + 1, 0);
    for (int64_t i = 0; i < n; ++i) ++start_[cell_of(points + 2 * i) + 1];
    for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    order_.resize(n);
    std::vector<int64_t> next(start_.begin(), start_.end() - 1);
    for (int64_t i = 0; i < n; ++i) order_[next[cell_of(points + 2 * i)]++] = static_cast<int32_t>(i);
  }

  void search(const int32_t *query, int k, int32_t *out) const {
    using Candidate = std::pair<int64_t, int32_t>;  // squared distance, index
    std::vector<Candidate> best;
    best.reserve(k + 1);
    const int64_t cx = axis(query[0], 0, nx_), cy = axis(query[1], 1, ny_);
    const int64_t rings = std::max(std::max(cx, nx_ - 1 - cx), std::max(cy, ny_ - 1 - cy));
    for (int64_t ring = 0; ring <= rings; ++ring) {
      if (static_cast<int>(best.size()) == k && reach(query, cx, cy, ring) > best.back().first) break;
      for (int64_t y = std::max<int64_t>(0, cy - ring); y <= std::min(ny_ - 1, cy + ring); ++y) {
        const bool whole = y == cy - ring || y == cy + ring;
        const int64_t step = whole ? 1 : std::max<int64_t>(1, 2 * ring);
        for (int64_t x = cx - ring; x <= cx + ring; x += step) {
          if (x < 0 || x >= nx_) continue;
          for (int64_t at = start_[y * nx_ + x]; at < start_[y * nx_ + x + 1]; ++at) {
            const int32_t i = order_[at];
            const int64_t dx = int64_t(points_[2 * i]) - query[0], dy = int64_t(points_[2 * i + 1]) - query[1];
            const Candidate candidate{dx * dx + dy * dy, i};
            if (static_cast<int>(best.size()) == k && !(candidate < best.back())) continue;
            best.insert(std::upper_bound(best.begin(), best.end(), candidate), candidate);
            if (static_cast<int>(best.size()) > k) best.pop_back();
          }
        }
      }
    }
    for (int j = 0; j < k; ++j) out[j] = j < static_cast<int>(best.size()) ? best[j].second : -1;
  }

 private:
  int64_t axis(int32_t v, int d, int64_t cells) const {
    const int64_t offset = int64_t(v) - lo_[d];
    return offset < 0 ? 0 : std::min(cells - 1, offset / side_);
  }
  int64_t cell_of(const int32_t *p) const { return axis(p[1], 1, ny_) * nx_ + axis(p[0], 0, nx_); }

  // No point in this ring or beyond is nearer than the root of this.
  int64_t reach(const int32_t *query, int64_t cx, int64_t cy, int64_t ring) const {
    if (ring == 0) return 0;
    const int64_t x = query[0] - int64_t(lo_[0]), y = query[1] - int64_t(lo_[1]);
    const int64_t d = std::min(std::min(x - (cx - ring + 1) * side_ + 1, (cx + ring) * side_ - x),
                               std::min(y - (cy - ring + 1) * side_ + 1, (cy + ring) * side_ - y));
    return d <= 0 ? 0 : d * d;
  }

  const int32_t *points_;
  int32_t lo_[2];
  int64_t side_, nx_, ny_;
  std::vector<int64_t> start_;
  std::vector<int32_t> order_;
};

}  // namespace

void nearest_neighbours(const int32_t *points, int64_t n, const int32_t *queries, int64_t m, int k, int threads,
                        int32_t *out) {
  if (n == 0) {
    std::fill(out, out + m * k, -1);
    return;
  }
  const Grid grid(points, n);
  constexpr int64_t kChunk = 256;
  parallel_for((m + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    for (int64_t i = chunk * kChunk; i < std::min(m, (chunk + 1) * kChunk); ++i)
      grid.search(queries + 2 * i, k, out + i * k);
  });
}

}  // namespace sgi
