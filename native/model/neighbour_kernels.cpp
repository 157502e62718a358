// Nearest neighbours in vectors of LANES / 2 doubles.
#ifdef SGI_X86
#include <immintrin.h>
#endif

#include "base/vector.hpp"
#include "model/neighbour_kernel.hpp"

namespace sgi {
namespace {

constexpr int kParts = kQueries / kDoubles;

inline vd least(vd a, vd b) { return a < b ? a : b; }
inline vd greatest(vd a, vd b) { return a > b ? a : b; }
inline double greatest(double a, double b) { return a > b ? a : b; }

// Which lanes of a are less than those of b, as bits.
inline uint32_t is_less(vd a, vd b) {
#if defined(SGI_X86) && LANES == 16
  return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
#elif defined(SGI_X86) && LANES == 8
  return uint32_t(_mm256_movemask_pd(_mm256_cmp_pd((__m256d)a, (__m256d)b, _CMP_LT_OQ)));
#elif defined(SGI_X86)
  return uint32_t(_mm_movemask_pd(_mm_cmplt_pd((__m128d)a, (__m128d)b)));
#else
  uint32_t mask = 0;
  for (int i = 0; i < kDoubles; ++i) mask |= uint32_t(a[i] < b[i]) << i;
  return mask;
#endif
}

// The square of how far [low, high] lies from [first, last].
inline vd gap(vd low, vd high, vd first, vd last) {
  const vd out = greatest(greatest(low - last, first - high), vd{});
  return out * out;
}

struct Queries {
  const PointRuns &runs;
  const double *x, *y;
  double *keys;
  double x0, y0, x1, y1;  // the box around them
  double bound;           // the greatest key that is of any use
};

inline double bound_of(const double *keys) {
  const double *last = keys + (kMaxNeighbours - 1) * kQueries;
  double most = last[0];
  for (int q = 1; q < kQueries; ++q) most = greatest(most, last[q]);
  return most;
}

// Which boxes of a node may hold a point that a query wants, as bits; how far they are from the middle of all queries.
inline uint32_t near_boxes(const Queries &of, const double *boxes, double *distance) {
  const vd x0 = vd{} + of.x0, y0 = vd{} + of.y0, x1 = vd{} + of.x1, y1 = vd{} + of.y1;
  const vd x = (x0 + x1) * 0.5, y = (y0 + y1) * 0.5;
  uint32_t mask = 0;
  for (int i = 0; i < kRun; i += kDoubles) {
    const vd left = load(boxes + i), top = load(boxes + kRun + i), right = load(boxes + 2 * kRun + i),
             bottom = load(boxes + 3 * kRun + i);
    const vd square = gap(left, right, x0, x1) + gap(top, bottom, y0, y1);
    mask |= is_less(square * of.runs.unit, vd{} + of.bound) << i;
    const vd away = gap(left, right, x, x) + gap(top, bottom, y, y);
    __builtin_memcpy(distance + i, &away, sizeof away);
  }
  return mask;
}

// Whether a query may want a point of this box.
inline bool is_wanted(const Queries &of, const double *box) {
  const double *last = of.keys + (kMaxNeighbours - 1) * kQueries;
  uint32_t wanted = 0;
  for (int q = 0; q < kQueries; q += kDoubles) {
    const vd x = load(of.x + q), y = load(of.y + q);
    const vd square =
        gap(vd{} + box[0], vd{} + box[2 * kRun], x, x) + gap(vd{} + box[kRun], vd{} + box[3 * kRun], y, y);
    wanted |= is_less(square * of.runs.unit, load(last + q));
  }
  return wanted != 0;
}

// Sorts the points of a leaf into the keys.
inline void look(Queries &of, int64_t leaf) {
  const double *points = of.runs.points + leaf * 2 * kRun;
  for (int part = 0; part < kParts; ++part) {
    double *keys = of.keys + part * kDoubles;
    const vd x = load(of.x + part * kDoubles), y = load(of.y + part * kDoubles);
    vd sorted[kMaxNeighbours];
    for (int j = 0; j < kMaxNeighbours; ++j) sorted[j] = load(keys + j * kQueries);
    for (int i = 0; i < kRun; ++i) {
      const vd dx = x - points[i], dy = y - points[kRun + i];
      const vd key = (dx * dx + dy * dy) * of.runs.unit + double(leaf * kRun + i);
#pragma GCC unroll 8
      for (int j = kMaxNeighbours - 1; j > 0; --j) sorted[j] = least(greatest(key, sorted[j - 1]), sorted[j]);
      sorted[0] = least(key, sorted[0]);
    }
    for (int j = 0; j < kMaxNeighbours; ++j) __builtin_memcpy(keys + j * kQueries, &sorted[j], sizeof(vd));
  }
  of.bound = bound_of(of.keys);
}

void visit(Queries &of, int level, int64_t number) {
  const double *node = of.runs.levels[level] + number * 4 * kRun;
  double distance[kRun];
  int order[kRun], count = 0;
  for (uint32_t mask = near_boxes(of, node, distance); mask; mask &= mask - 1) {
    const int child = __builtin_ctz(mask);
    int at = count++;
    for (; at > 0 && distance[order[at - 1]] > distance[child]; --at) order[at] = order[at - 1];
    order[at] = child;
  }
  for (int i = 0; i < count; ++i) {
    if (!is_wanted(of, node + order[i])) continue;
    if (level)
      visit(of, level - 1, number * kRun + order[i]);
    else
      look(of, number * kRun + order[i]);
  }
}

void search(const PointRuns &runs, const double *x, const double *y, double *keys) {
  Queries of{runs, x, y, keys, x[0], y[0], x[0], y[0], bound_of(keys)};
  for (int q = 1; q < kQueries; ++q) {
    of.x0 = x[q] < of.x0 ? x[q] : of.x0, of.y0 = y[q] < of.y0 ? y[q] : of.y0;
    of.x1 = greatest(of.x1, x[q]), of.y1 = greatest(of.y1, y[q]);
  }
  visit(of, runs.depth - 1, 0);
}

}  // namespace

const NeighbourKernel NeighbourKernel::SGI_ISA{sgi::search};

}  // namespace sgi
