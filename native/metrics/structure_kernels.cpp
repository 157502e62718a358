#include "metrics/blur.hpp"
#include "metrics/structure_kernel.hpp"

namespace sgi {
namespace {

constexpr float kC2 = 0.0009f;  // of SSIM

// 1 - SSIM around a pixel, from what the blurs hold: the mean of the difference, its variance, and its covariance with
// the reference. The variances of both pictures are in the denominator.
struct StructureLoss {
  vf mean, spread, similar, ratio, value;

  StructureLoss(vf reference_mean, vf reference_variance, vf one, vf square, vf product) : mean(one) {
    const vf variance = square - one * one, covariance = product - reference_mean * one;
    spread = 2.0f * (reference_variance + covariance) + variance + kC2;
    similar = 1.0f - one * one;
    ratio = variance / spread;
    value = maxv(one * one + similar * ratio, vf{});
  }
};

// By how much the decoded picture's edge at a pixel is stronger than the reference's.
struct EdgeChange {
  vf decoded, strength, value;

  EdgeChange(vf value, vf mean, vf difference, vf one) {
    const vf reference = value - mean;
    decoded = reference + (difference - one);
    strength = absv(reference) + 1.0f;
    this->value = (absv(decoded) - absv(reference)) / strength;
  }
};

// Adds up a map along a row.
struct RowSums {
  vf one{}, four{};

  void add(vf value) {
    const vf square = value * value;
    one += value;
    four += square * square;
  }
  void add_to(MapSums &sums, VisualMap map) const {
    for (int i = 0; i < LANES; ++i) {
      sums.sum[2 * map] += double(lane(one, i));
      sums.sum[2 * map + 1] += double(lane(four, i));
    }
  }
};

void describe(const float *value, MapPlane plane, int64_t y, float *mean, float *variance, float *scratch) {
  const int64_t stride = padded(plane.width);
  const BlurRows rows(value, plane, y);
  const BlurColumns means(scratch, plane.width), squares(scratch + scratch_row(plane.width), plane.width);
  for (int64_t x = 0; x < stride; x += LANES) {
    vf sum{}, square{};
    for (int i = -kReach; i <= kReach; ++i) {
      const vf v = rows.at(i, x), weighted = kTaps[i < 0 ? -i : i] * v;
      sum += weighted;
      square += weighted * v;
    }
    store(means.row + x, sum);
    store(squares.row + x, square);
  }
  for (int64_t x = 0; x < stride; x += LANES) {
    const vf found = means.at(x);
    store(mean + x, found);
    if (variance) store(variance + x, squares.at(x) - found * found);
  }
}

// A row of the blurs of a difference e from the reference r, of which `at` gives the last half: of e, e^2 and r e.
template <bool kWithStructure>
class DifferenceBlurs {
 public:
  DifferenceBlurs(const float *reference, const float *difference, MapPlane plane, int64_t y, float *scratch)
      : columns_{{scratch, plane.width},
                 {scratch + scratch_row(plane.width), plane.width},
                 {scratch + 2 * scratch_row(plane.width), plane.width}} {
    const BlurRows differences(difference, plane, y), references(reference, plane, y);
    for (int64_t x = 0; x < padded(plane.width); x += LANES) {
      if (!kWithStructure) {
        store(columns_[0].row + x, differences.sum(x));
        continue;
      }
      const vf middle = differences.at(0, x), weighted = kTaps[0] * middle;
      vf one = weighted, square = weighted * middle, product = weighted * references.at(0, x);
      for (int i = 1; i <= kReach; ++i) {
        const vf above = differences.at(-i, x), below = differences.at(i, x);
        one += kTaps[i] * (above + below);
        square += kTaps[i] * (above * above + below * below);
        product += kTaps[i] * (above * references.at(-i, x) + below * references.at(i, x));
      }
      store(columns_[0].row + x, one);
      store(columns_[1].row + x, square);
      store(columns_[2].row + x, product);
    }
  }
  vf one(int64_t x) const { return columns_[0].at(x); }
  vf square(int64_t x) const { return columns_[1].at(x); }
  vf product(int64_t x) const { return columns_[2].at(x); }

 private:
  const BlurColumns columns_[3];
};

template <bool kWithStructure>
void compare_row(const ReferencePlanes &reference, const float *difference, MapPlane plane, int64_t y, MapSums &sums,
                 float *scratch) {
  const int64_t at = y * padded(plane.width);
  const DifferenceBlurs<kWithStructure> blurs(reference.value, difference, plane, y, scratch);
  RowSums structure, added, lost;
  for (int64_t x = 0; x < plane.width; x += LANES) {
    const vi live = inside(x, plane.width);
    const vf one = blurs.one(x), mean = load(reference.mean + at + x);
    if (kWithStructure) {
      const StructureLoss loss(mean, load(reference.variance + at + x), one, blurs.square(x), blurs.product(x));
      structure.add(zero_unless(live, loss.value));
    }
    const EdgeChange change(load(reference.value + at + x), mean, load(difference + at + x), one);
    const vf counted = zero_unless(live, change.value);
    added.add(maxv(counted, vf{}));
    lost.add(maxv(-counted, vf{}));
  }
  structure.add_to(sums, kStructure);
  added.add_to(sums, kAdded);
  lost.add_to(sums, kLost);
}

void compare(const ReferencePlanes &reference, const float *difference, MapPlane plane, int64_t y, MapSums &sums,
             float *scratch) {
  (reference.variance ? compare_row<true> : compare_row<false>)(reference, difference, plane, y, sums, scratch);
}

vf slope_at(const MapSlope &slope, vf value) {
  return zero_unless(value > 0.0f, slope.linear + slope.cubic * (value * value * value));
}

template <bool kWithStructure>
void slope_row(const ReferencePlanes &reference, const float *difference, MapPlane plane, int64_t y,
               const MapSlope *slopes, const BlurSlopes &out, float *scratch) {
  const int64_t stride = padded(plane.width), at = y * stride;
  const DifferenceBlurs<kWithStructure> blurs(reference.value, difference, plane, y, scratch);
  for (int64_t x = 0; x < stride; x += LANES) {
    const vi live = inside(x, plane.width);
    const vf one = blurs.one(x), mean = load(reference.mean + at + x);
    const EdgeChange change(load(reference.value + at + x), mean, load(difference + at + x), one);
    const vf edge =
        zero_unless(live, (slope_at(slopes[kAdded], change.value) - slope_at(slopes[kLost], -change.value)) *
                              signv(change.decoded) / change.strength);
    store(out.direct + x, edge);
    vf in_one = -edge;
    if (kWithStructure) {
      const StructureLoss loss(mean, load(reference.variance + at + x), one, blurs.square(x), blurs.product(x));
      const vf slope = slope_at(slopes[kStructure], loss.value), shared = slope * loss.similar / loss.spread;
      const vf in_variance = shared * (1.0f - loss.ratio), in_covariance = -2.0f * shared * loss.ratio;
      in_one += zero_unless(live, 2.0f * one * (slope * (1.0f - loss.ratio) - in_variance) - mean * in_covariance);
      store(out.square + x, zero_unless(live, in_variance));
      store(out.product + x, zero_unless(live, in_covariance));
    }
    store(out.one + x, in_one);
  }
}

void slope(const ReferencePlanes &reference, const float *difference, MapPlane plane, int64_t y, const MapSlope *slopes,
           const BlurSlopes &out, float *scratch) {
  (reference.variance ? slope_row<true> : slope_row<false>)(reference, difference, plane, y, slopes, out, scratch);
}

void gather(const ReferencePlanes &reference, const float *difference, const BlurSlopes &slopes, MapPlane plane,
            int64_t y, float *gradient, float *scratch) {
  const int64_t stride = padded(plane.width), at = y * stride, room = scratch_row(plane.width);
  const float *const direct = slopes.direct + y % kRingRows * stride;
  const float *const rings[3] = {slopes.one, slopes.square, slopes.product};
  const BlurColumns columns[3] = {
      {scratch, plane.width}, {scratch + room, plane.width}, {scratch + 2 * room, plane.width}};
  const int blurred = reference.variance ? 3 : 1;
  for (int i = 0; i < blurred; ++i) {
    const BlurRows rows(rings[i], plane, y, kRingRows);
    for (int64_t x = 0; x < stride; x += LANES) store(columns[i].row + x, rows.sum(x));
  }
  for (int64_t x = 0; x < stride; x += LANES) {
    vf sum = load(direct + x) + columns[0].at(x);
    if (blurred == 3)
      sum += 2.0f * load(difference + at + x) * columns[1].at(x) + load(reference.value + at + x) * columns[2].at(x);
    store(gradient + x, sum);
  }
}

}  // namespace

const StructureKernel StructureKernel::SGI_ISA{sgi::describe, sgi::compare, sgi::slope, sgi::gather};

}  // namespace sgi
