// Nearest neighbours in vectors of LANES integers.
#ifdef SGI_X86
#include <immintrin.h>
#endif

#include "model/neighbour_kernel.hpp"
#include "model/pair_products.hpp"

namespace sgi {
namespace {

using narrow::load, narrow::multiply_pairs, narrow::store, narrow::vi;

constexpr int kParts = kQueries / LANES;

inline vi least(vi a, vi b) { return a < b ? a : b; }
inline vi greatest(vi a, vi b) { return a > b ? a : b; }

// Which lanes of a are no more than those of b, as bits.
inline uint32_t is_within(vi a, vi b) {
#if defined(SGI_X86) && LANES == 16
  return _mm512_cmple_epi32_mask((__m512i)a, (__m512i)b);
#elif defined(SGI_X86) && LANES == 8
  return uint32_t(_mm256_movemask_ps((__m256)(a <= b)));
#elif defined(SGI_X86)
  return uint32_t(_mm_movemask_ps((__m128)(a <= b)));
#else
  uint32_t mask = 0;
  for (int i = 0; i < LANES; ++i) mask |= uint32_t(a[i] <= b[i]) << i;
  return mask;
#endif
}

// How far [low, high] lies from [first, last].
inline vi gap(vi low, vi high, vi first, vi last) { return greatest(greatest(low - last, first - high), vi{}); }

// The square of (x, y), both 0 ... kFar.
inline vi square_of(vi x, vi y) {
  const vi both = x | y << 16;
  return multiply_pairs(both, both);
}

struct Queries {
  const PointRuns &runs;
  const int32_t *x, *y;
  int32_t *keys;
  int32_t x0, y0, x1, y1;  // the box around them
  int32_t bound;           // the greatest square of a distance that is of any use
  vi places[kParts];       // packed

  vi bounds(int part) const { return load(keys + (kMaxNeighbours - 1) * kQueries + part * LANES); }

  void set_bound() {
    vi most = bounds(0);
    for (int part = 1; part < kParts; ++part) most = greatest(most, bounds(part));
    int32_t all = most[0];
    for (int i = 1; i < LANES; ++i) all = most[i] > all ? most[i] : all;
    bound = all >> runs.number_bits;
  }
};

// Which boxes of a node may hold a point that a query wants, as bits; how far they are from the middle of all queries.
inline uint32_t near_boxes(const Queries &of, const int32_t *boxes, int32_t *distance) {
  const vi x0 = vi{} + of.x0, y0 = vi{} + of.y0, x1 = vi{} + of.x1, y1 = vi{} + of.y1;
  const vi x = (x0 + x1) >> 1, y = (y0 + y1) >> 1;
  uint32_t mask = 0;
  for (int i = 0; i < kRun; i += LANES) {
    const vi left = load(boxes + i), top = load(boxes + kRun + i), right = load(boxes + 2 * kRun + i),
             bottom = load(boxes + 3 * kRun + i);
    mask |= is_within(square_of(gap(left, right, x0, x1), gap(top, bottom, y0, y1)), vi{} + of.bound) << i;
    store(distance + i, square_of(gap(left, right, x, x), gap(top, bottom, y, y)));
  }
  return mask;
}

// Whether a query may want a point of this box.
inline bool is_wanted(const Queries &of, const int32_t *box) {
  uint32_t wanted = 0;
  for (int part = 0; part < kParts; ++part) {
    const vi x = load(of.x + part * LANES), y = load(of.y + part * LANES);
    const vi square =
        square_of(gap(vi{} + box[0], vi{} + box[2 * kRun], x, x), gap(vi{} + box[kRun], vi{} + box[3 * kRun], y, y));
    wanted |= is_within(square, of.bounds(part) >> of.runs.number_bits);
  }
  return wanted != 0;
}

// From one place to another, both packed.
inline vi way(vi from, vi to) {
  using Halves = int16_t __attribute__((vector_size(LANES * 4)));
  return (vi)((Halves)to - (Halves)from);
}

// Sorts the points of a leaf into the keys.
inline void look(Queries &of, int64_t leaf) {
  const int32_t *points = of.runs.points + leaf * kRun;
  const vi most = vi{} + of.runs.max_square();
  for (int part = 0; part < kParts; ++part) {
    int32_t *keys = of.keys + part * LANES;
    vi sorted[kMaxNeighbours];
    for (int j = 0; j < kMaxNeighbours; ++j) sorted[j] = load(keys + j * kQueries);
    for (int i = 0; i < kRun; ++i) {
      const vi to = way(of.places[part], vi{} + points[i]);
      const vi key = (least(multiply_pairs(to, to), most) << of.runs.number_bits) + int32_t(leaf * kRun + i);
#pragma GCC unroll 8
      for (int j = kMaxNeighbours - 1; j > 0; --j) sorted[j] = least(greatest(key, sorted[j - 1]), sorted[j]);
      sorted[0] = least(key, sorted[0]);
    }
    for (int j = 0; j < kMaxNeighbours; ++j) store(keys + j * kQueries, sorted[j]);
  }
  of.set_bound();
}

void visit(Queries &of, int level, int64_t number) {
  const int32_t *node = of.runs.levels[level] + number * 4 * kRun;
  int32_t distance[kRun];
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

void search(const PointRuns &runs, const int32_t *x, const int32_t *y, int32_t *keys) {
  Queries of{runs, x, y, keys, x[0], y[0], x[0], y[0], 0, {}};
  of.set_bound();
  for (int q = 1; q < kQueries; ++q) {
    of.x0 = x[q] < of.x0 ? x[q] : of.x0, of.y0 = y[q] < of.y0 ? y[q] : of.y0;
    of.x1 = x[q] > of.x1 ? x[q] : of.x1, of.y1 = y[q] > of.y1 ? y[q] : of.y1;
  }
  for (int part = 0; part < kParts; ++part) of.places[part] = load(x + part * LANES) | load(y + part * LANES) << 16;
  visit(of, runs.depth - 1, 0);
}

}  // namespace

const NeighbourKernel NeighbourKernel::SGI_ISA{sgi::search};

}  // namespace sgi
