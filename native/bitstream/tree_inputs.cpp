#include "bitstream/tree_inputs.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int kRank[4] = {0, 2, 3, 1};  // where each child number stands in kChildren
static_assert(kRank[kChildren[0]] == 0 && kRank[kChildren[1]] == 1 && kRank[kChildren[2]] == 2 &&
              kRank[kChildren[3]] == 3);
constexpr int kOne = 64, kCounts = 4;  // inputs are in 1/64, counts in quarters

int half_down(int v) { return (v + 4) / 2 - 2; }

// The number of side (dx, dy), kSides for the node itself.
int side_of(int dx, int dy) {
  for (int side = 0; side < kSides; ++side)
    if (kSideX[side] == dx && kSideY[side] == dy) return side;
  return kSides;
}

struct Place {
  int side, child;  // a node as child of a neighbour of the parent
};

Place place_beside(int child, int dx, int dy) {
  const int x = (child & 1) + dx, y = (child >> 1) + dy;
  return {side_of(half_down(x), half_down(y)), (x & 1) + 2 * (y & 1)};
}

// The nodes in 5 x 5 around a child that are coded in an earlier batch of its level, row by row.
std::vector<Place> known_beside(int child) {
  std::vector<Place> known;
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      const Place place = place_beside(child, dx, dy);
      if (kRank[place.child] < kRank[child]) known.push_back(place);
    }
  return known;
}

int16_t octaves(int64_t v) {  // 16 log2(v + 1), in steps of 2 and between powers of two along straight lines
  int exponent = 0;
  while ((v + 1) >> (exponent + 1)) ++exponent;
  return int16_t(2 * (8 * exponent + (((v + 1) << 3) >> exponent) - 8));
}

// Seed of a split node and the numbers of split nodes and of seeds in 3 x 3 around it, itself included.
void summarise_node(const int16_t *above, int16_t *summary) {
  int split = kOne, seed = above[0];
  for (int side = 0; side < kSides; ++side) split += above[1 + 3 * side], seed += above[2 + 3 * side];
  summary[0] = above[0], summary[1] = int16_t(split / kCounts), summary[2] = int16_t(seed / kCounts);
}

}  // namespace

int tree_input_count(int child) { return kFixedInputs + 2 * int(known_beside(child).size()); }

void base_detail(const int64_t *base, int64_t channels, int64_t rows, int64_t columns, int16_t *out) {
  for (int64_t i = 0; i < rows; ++i)
    for (int64_t j = 0; j < columns; ++j) {
      const int64_t up = std::max(i - 1, int64_t(0)) * columns, down = std::min(i + 1, rows - 1) * columns;
      const int64_t left = std::max(j - 1, int64_t(0)), right = std::min(j + 1, columns - 1), here = i * columns;
      int64_t slope[2] = {0, 0}, bend[2] = {0, 0}, most = 0;
      for (int64_t c = 0; c < channels; ++c) {
        const int64_t *plane = base + c * rows * columns;
        const int64_t v = plane[here + j], w = plane[here + left], e = plane[here + right], n = plane[up + j],
                      s = plane[down + j];
        slope[c > 0] += std::abs(e - w) + std::abs(s - n);
        bend[c > 0] += std::abs(w + e + n + s - 4 * v);
        int64_t differs = 0;
        for (const int64_t other :
             {w, e, n, s, plane[up + left], plane[up + right], plane[down + left], plane[down + right]})
          differs = std::max(differs, std::abs(other - v));
        most += differs;
      }
      int16_t *cell = out + (here + j) * kDetail;
      cell[0] = octaves(slope[0]), cell[1] = octaves(slope[1]), cell[2] = octaves(bend[0]), cell[3] = octaves(bend[1]);
      cell[4] = octaves(most);
    }
}

void children_inside(const SplitNodes &parents, int level, int64_t width, int64_t height, uint8_t *exists) {
  std::fill_n(exists + 4 * parents.count, 4, uint8_t(0));
  for (int64_t p = 0; p < parents.count; ++p)
    for (int child = 0; child < 4; ++child)
      exists[4 * p + child] = (2 * int64_t(parents.x[p]) + (child & 1)) << level < width &&
                              (2 * int64_t(parents.y[p]) + (child >> 1)) << level < height;
}

int64_t begin_batch(int64_t count, const uint8_t *exists, const uint8_t *occupied, int child, int32_t *members,
                    uint8_t *needed) {
  int64_t n = 0;
  for (int64_t p = 0; p < count; ++p) {
    uint8_t later = 0;
    for (int other = 0; other < 4; ++other) later |= exists[4 * p + other] & uint8_t(kRank[other] > kRank[child]);
    members[n] = int32_t(p);
    needed[n] = uint8_t(!later && !occupied[p]);
    n += exists[4 * p + child];
  }
  return n;
}

void end_batch(const int32_t *members, int64_t n, int child, const uint8_t *split_flags, const uint8_t *seed_flags,
               int16_t *flags, uint8_t *occupied) {
  for (int64_t i = 0; i < n; ++i) {
    int16_t *slot = flags + 8 * int64_t(members[i]) + 2 * child;
    slot[0] = int16_t(kOne * split_flags[i]), slot[1] = int16_t(kOne * seed_flags[i]);
    occupied[members[i]] |= split_flags[i] | seed_flags[i];
  }
}

void tree_inputs(const SplitNodes &parents, const Slots &slots, const BaseDetail &detail, const int16_t *head,
                 int level, int child, const int32_t *members, int64_t n, int16_t *out) {
  const std::vector<Place> known = known_beside(child);
  for (int64_t i = 0; i < n; ++i) {
    const int64_t p = members[i];
    out = std::copy(head, head + kHead, out);
    if (detail.values) {
      const int64_t x = 2 * int64_t(parents.x[p]) + (child & 1), y = 2 * int64_t(parents.y[p]) + (child >> 1);
      const int64_t column = std::min((((2 * x + 1) << level) >> 1) / detail.cell, detail.columns - 1);
      const int64_t row = std::min((((2 * y + 1) << level) >> 1) / detail.cell, detail.rows - 1);
      const int16_t *values = detail.values + (row * detail.columns + column) * kDetail;
      out = std::copy(values, values + kDetail, out);
    } else {
      out = std::fill_n(out, kDetail, int16_t(0));
    }
    out = std::copy_n(parents.above + p * kAbove, kAbove, out);
    for (const Place &place : known) {
      const int64_t owner = place.side == kSides ? p : parents.neighbour[p * kSides + place.side];
      out = std::copy_n(slots.flags + 8 * owner + 2 * place.child, 2, out);
    }
  }
}

void tree_rows(const Network &network, const SplitNodes &parents, const Slots &slots, const BaseDetail &detail,
               const int16_t *head, int level, int child, const int32_t *members, int64_t n, int shift, int most,
               int threads, int16_t *rows) {
  constexpr int64_t kChunk = 512;
  const int inputs = tree_input_count(child), outputs = network.outputs();
  parallel_for((n + kChunk - 1) / kChunk, threads, [&](int64_t chunk) {
    const int64_t begin = chunk * kChunk, count = std::min(n - begin, kChunk);
    const std::unique_ptr<int16_t[]> in(new int16_t[count * inputs]);  // not zeroed, as a vector would be
    const std::unique_ptr<int64_t[]> odds(new int64_t[count * outputs]);
    const std::unique_ptr<double[]> scratch(new double[network.scratch_size()]);
    tree_inputs(parents, slots, detail, head, level, child, members + begin, count, in.get());
    network.evaluate(in.get(), inputs, count, scratch.get(), odds.get());
    for (int64_t i = 0; i < count * outputs; ++i) {
      const int64_t row = (odds[i] + (int64_t(1) << (shift - 1))) >> shift;
      rows[begin * outputs + i] = int16_t(std::min(std::max(row, int64_t(-most)), int64_t(most)) + most);
    }
  });
}

void split_children(const SplitNodes &parents, const Slots &slots, const int32_t *found, int64_t m, int32_t *number,
                    int32_t *x, int32_t *y, int32_t *neighbour, int16_t *above) {
  std::array<Place, 4 * kSides> places;
  for (int child = 0; child < 4; ++child)
    for (int side = 0; side < kSides; ++side)
      places[child * kSides + side] = place_beside(child, kSideX[side], kSideY[side]);
  std::fill_n(number, 4 * (parents.count + 1), int32_t(m));
  for (int64_t i = 0; i < m; ++i) number[found[i]] = int32_t(i);
  for (int64_t i = 0; i < m; ++i) {
    const int64_t p = found[i] >> 2;
    const int child = found[i] & 3;
    x[i] = 2 * parents.x[p] + (child & 1), y[i] = 2 * parents.y[p] + (child >> 1);
    int16_t *of = above + i * kAbove;
    of[0] = slots.flags[2 * int64_t(found[i]) + 1];
    for (int side = 0; side < kSides; ++side) {
      const Place place = places[child * kSides + side];
      const int64_t owner = place.side == kSides ? p : parents.neighbour[p * kSides + place.side];
      const int64_t slot = 4 * owner + place.child;
      neighbour[i * kSides + side] = number[slot];
      of[1 + 3 * side] = slots.flags[2 * slot], of[2 + 3 * side] = slots.flags[2 * slot + 1];
      of[3 + 3 * side] = int16_t(kOne * slots.exists[slot]);
    }
    const int16_t *over = parents.above + p * kAbove;
    summarise_node(over, of + kAbove - 6);
    std::copy_n(over + kAbove - 6, 3, of + kAbove - 3);
  }
}

}  // namespace sgi
