#include "base/inline.hpp"
#include "metrics/malta_kernel.hpp"
#include "metrics/maps.hpp"
#include "metrics/rows.hpp"

namespace sgi {
namespace {

// Places of a line to one side of its centre; the other side mirrors them.
struct Line {
  int count;
  struct {
    int y, x;
  } at[kMaltaReach];
  float weight;
};

struct LineSet {
  int count;
  Line line[kMaxMaltaLines];
};

constexpr LineSet kFine{12,
                        {{4, {{0, 1}, {0, 2}, {0, 3}, {0, 4}}, 1},
                         {4, {{1, 0}, {2, 0}, {3, 0}, {4, 0}}, 1},
                         {3, {{1, 1}, {2, 2}, {3, 3}}, 1},
                         {3, {{1, -1}, {2, -2}, {3, -3}}, 1},
                         {4, {{1, 0}, {2, -1}, {3, -1}, {4, -1}}, 2},
                         {4, {{1, 0}, {2, 1}, {3, 1}, {4, 1}}, 2},
                         {4, {{0, 1}, {1, 2}, {1, 3}, {1, 4}}, 2},
                         {4, {{0, 1}, {-1, 2}, {-1, 3}, {-1, 4}}, 2},
                         {3, {{1, 1}, {2, 1}, {3, 2}}, 1},
                         {3, {{1, -1}, {2, -1}, {3, -2}}, 1},
                         {3, {{1, 1}, {1, 2}, {2, 3}}, 1},
                         {3, {{1, -1}, {1, -2}, {2, -3}}, 1}}};

constexpr LineSet kCoarse{16,
                          {{2, {{0, 2}, {0, 4}}, 1},
                           {2, {{2, 0}, {4, 0}}, 1},
                           {2, {{2, 2}, {3, 3}}, 1},
                           {2, {{2, -2}, {3, -3}}, 1},
                           {2, {{2, -1}, {4, -1}}, 1},
                           {2, {{2, 1}, {4, 1}}, 1},
                           {2, {{1, 2}, {1, 4}}, 1},
                           {2, {{-1, 2}, {-1, 4}}, 1},
                           {2, {{2, 1}, {3, 2}}, 1},
                           {2, {{2, -1}, {3, -2}}, 1},
                           {2, {{1, 2}, {2, 3}}, 1},
                           {2, {{1, -2}, {2, -3}}, 1},
                           {2, {{1, -2}, {2, -4}}, 1},
                           {2, {{1, 2}, {2, 4}}, 1},
                           {2, {{2, 1}, {4, 2}}, 1},
                           {2, {{2, -1}, {4, -2}}, 1}}};

constexpr float kOutsideLeast = 0.55f, kOutsideMost = 1.05f;

struct Outside {
  vf low, high;

  explicit Outside(vf original)
      : low(minv(kOutsideLeast * original, kOutsideMost * original)),
        high(maxv(kOutsideLeast * original, kOutsideMost * original)) {}
};

vf moved_by(vf original, vf seen, const MaltaWeights &weights, vf &scale) {
  const Outside outside(original);
  scale = 1.0f / (weights.norm + 0.5f * (absv(original) + absv(seen)));
  const vf nearest = minv(maxv(seen, outside.low), outside.high);
  return (weights.all * (original - seen) + weights.outside * (nearest - seen)) * scale;
}

void move(const float *original, const float *seen, int64_t width, const MaltaWeights &weights, float *moved) {
  vf scale;
  for (int64_t x = 0; x < width; x += LANES)
    store(moved + x, zero_unless(inside(x, width), moved_by(load(original + x), load(seen + x), weights, scale)));
}

// Rows around one, by their distance from it.
struct NearRows {
  const float *row[2 * kMaltaReach + 1];
};

// The sum along a line through column x.
SGI_INLINE vf along(const Line &line, const NearRows &rows, int64_t x) {
  vf sum = load(rows.row[kMaltaReach] + x);
  for (int i = 0; i < line.count; ++i)
    sum += load(rows.row[kMaltaReach + line.at[i].y] + x + line.at[i].x) +
           load(rows.row[kMaltaReach - line.at[i].y] + x - line.at[i].x);
  return sum;
}

NearRows rows_around(const float *row, int64_t stride) {
  NearRows rows;
  for (int i = -kMaltaReach; i <= kMaltaReach; ++i) rows.row[kMaltaReach + i] = row + i * stride;
  return rows;
}

template <const LineSet &SET>
void add_lines(const float *moved, int64_t stride, int64_t width, float *sums) {
  const NearRows rows = rows_around(moved, stride);
  for (int64_t x = 0; x < width; x += LANES) {
    vf sum = load(sums + x);
#pragma GCC unroll 16
    for (int i = 0; i < SET.count; ++i) {
      const vf line = along(SET.line[i], rows, x);
      sum += SET.line[i].weight * line * line;
    }
    store(sums + x, sum);
  }
}

void add(MaltaLines lines, const float *moved, int64_t stride, int64_t width, float *sums) {
  (lines == MaltaLines::kFine ? add_lines<kFine> : add_lines<kCoarse>)(moved, stride, width, sums);
}

template <const LineSet &SET>
void line_slopes(const float *moved, int64_t stride, int64_t width, const float *slope, float *rings, int64_t y,
                 int64_t ring_stride) {
  const NearRows rows = rows_around(moved, stride);
  float *const to = rings + y % kMaltaRingRows * ring_stride;
  for (int64_t x = 0; x < width; x += LANES) {
    const vf twice = 2.0f * load(slope + x);
#pragma GCC unroll 16
    for (int i = 0; i < SET.count; ++i)
      store(to + i * kMaltaRingRows * ring_stride + x, SET.line[i].weight * twice * along(SET.line[i], rows, x));
  }
}

void slopes(MaltaLines lines, const float *moved, int64_t stride, int64_t width, const float *slope, float *rings,
            int64_t y, int64_t ring_stride) {
  (lines == MaltaLines::kFine ? line_slopes<kFine> : line_slopes<kCoarse>)(moved, stride, width, slope, rings, y,
                                                                           ring_stride);
}

template <const LineSet &SET>
void gather_lines(const float *rings, int64_t y, int64_t ring_stride, const float *original, const float *seen,
                  int64_t width, const MaltaWeights &weights, float *gradient) {
  int64_t row_at[2 * kMaltaReach + 1];
  for (int i = -kMaltaReach; i <= kMaltaReach; ++i)
    row_at[kMaltaReach + i] = (y + i + kMaltaRingRows) % kMaltaRingRows * ring_stride;
  for (int64_t x = 0; x < width; x += LANES) {
    vf sum{};
#pragma GCC unroll 16
    for (int i = 0; i < SET.count; ++i) {
      NearRows rows;
      for (int j = 0; j <= 2 * kMaltaReach; ++j) rows.row[j] = rings + i * kMaltaRingRows * ring_stride + row_at[j];
      sum += along(SET.line[i], rows, x);
    }
    const vf from = load(original + x), value = load(seen + x);
    const Outside outside(from);
    vf scale;
    const vf moved = moved_by(from, value, weights, scale);
    vf direct = vf{} + weights.all;
    direct += select((value < outside.low) | (value > outside.high), vf{} + weights.outside, vf{});
    const vf slope = -scale * (direct + 0.5f * moved * signv(value));
    store(gradient + x, zero_unless(inside(x, width), sum * slope));
  }
}

void gather(MaltaLines lines, const float *rings, int64_t y, int64_t ring_stride, const float *original,
            const float *seen, int64_t width, const MaltaWeights &weights, float *gradient) {
  (lines == MaltaLines::kFine ? gather_lines<kFine> : gather_lines<kCoarse>)(rings, y, ring_stride, original, seen,
                                                                             width, weights, gradient);
}

}  // namespace

const MaltaKernel MaltaKernel::SGI_ISA{sgi::move, sgi::add, sgi::slopes, sgi::gather};

}  // namespace sgi
