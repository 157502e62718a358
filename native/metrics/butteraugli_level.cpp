#include "metrics/butteraugli_level.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "metrics/bands.hpp"

namespace sgi {
namespace {

constexpr double kAddedShare = 0.8;  // how much less it counts that something is added at high frequencies

// Rows of planes at one place.
template <class T, size_t COUNT>
struct PlaneRows {
  T *row[COUNT];

  template <class Planes>
  PlaneRows(Planes &planes, int64_t y) {
    for (size_t c = 0; c < COUNT; ++c) row[c] = planes[c].row(y);
  }
  operator T *const *() const { return row; }
};

template <size_t COUNT>
PlaneRows<const float, COUNT> rows_at(const std::array<BorderedPlane, COUNT> &planes, int64_t y) {
  return {planes, y};
}

template <size_t COUNT>
PlaneRows<float, COUNT> rows_at(std::array<BorderedPlane, COUNT> &planes, int64_t y) {
  return {planes, y};
}

// The channels of three that are looked at in detail.
template <class T>
PlaneRows<T, 2> two_rows_at(std::array<BorderedPlane, 3> &planes, int64_t y) {
  return {planes, y};
}

template <class T, class Planes>
SeenRows<T> seen_rows(Planes &planes, int64_t y) {
  SeenRows<T> rows;
  for (int c = 0; c < 3; ++c) rows.lf[c] = planes.lf[c].row(y), rows.mf[c] = planes.mf[c].row(y);
  for (int c = 0; c < 2; ++c) rows.hf[c] = planes.hf[c].row(y), rows.uhf[c] = planes.uhf[c].row(y);
  rows.mask = planes.mask.row(y);
  return rows;
}

}  // namespace

MaltaWeights::MaltaWeights(MaltaLines lines, double weight, double norm_, double asymmetry) : norm(float(norm_)) {
  const double factor = (lines == MaltaLines::kFine ? 0.39905817637 : 0.611612573796) / 8.5 * norm_;
  all = float(factor * std::sqrt(0.5 * asymmetry * weight));
  outside = float(factor * std::sqrt(0.33 / asymmetry * weight));
}

SeenRows<const float> SeenPlanes::rows(int64_t y) const { return seen_rows<const float>(*this, y); }
SeenRows<float> SeenPlanes::rows(int64_t y) { return seen_rows<float>(*this, y); }

template <class Body>
void ButteraugliLevel::each_row(Body body) const {
  each_band(size_.height, threads_, [&](int64_t, int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) body(y);
  });
}

template <int COUNT>
BorderedPlanes<COUNT> ButteraugliLevel::planes() const {
  BorderedPlanes<COUNT> found;
  for (BorderedPlane &one : found) one = plane();
  return found;
}

ButteraugliLevel::ButteraugliLevel(const BorderedPlanes<3> &light, MapPlane size, int threads, Isa isa)
    : size_(size), threads_(threads), kernel_(kernel_for<ButteraugliKernel>(isa)), malta_(kernel_for<MaltaKernel>(isa)),
      light_blur_(1.2, size, BlurBorder::kMirrored, threads, isa),
      low_blur_(7.15593339443, size, BlurBorder::kNone, threads, isa),
      middle_blur_(3.22489901262, size, BlurBorder::kNone, threads, isa),
      high_blur_(1.56416327805, size, BlurBorder::kNone, threads, isa),
      mask_blur_(2.7, size, BlurBorder::kNone, threads, isa), original_(see(light)), details_(plane()),
      ground_(plane()) {
  original_.rest = {};
  const BorderedPlane hidden = eroded(original_.mask);
  each_row([&](int64_t y) { kernel_.visibility(hidden.row(y), size_.width, details_.row(y), ground_.row(y)); });
}

OriginalRows ButteraugliLevel::original(int64_t y) const {
  return {original_.rows(y), details_.row(y), ground_.row(y)};
}

BorderedPlanes<3> ButteraugliLevel::around(const BorderedPlanes<3> &light) const {
  BorderedPlanes<3> blurred = planes<3>();
  for (int c = 0; c < 3; ++c) light_blur_.blur(light[c], blurred[c]);
  return blurred;
}

SeenPlanes ButteraugliLevel::see(const BorderedPlanes<3> &light) const {
  const int64_t width = size_.width;
  SeenPlanes seen{planes<3>(), planes<3>(), planes<2>(), planes<2>(), {}, plane()};
  BorderedPlanes<3> left = planes<3>();
  {
    const BorderedPlanes<3> near = around(light);
    each_row([&](int64_t y) { kernel_.opsin(rows_at(light, y), rows_at(near, y), width, rows_at(left, y)); });
  }
  for (int c = 0; c < 3; ++c) low_blur_.blur(left[c], seen.lf[c]);
  each_row([&](int64_t y) { kernel_.split_low(rows_at(left, y), rows_at(seen.lf, y), width); });
  for (int c = 0; c < 3; ++c) middle_blur_.blur(left[c], seen.mf[c]);
  BorderedPlane red = std::move(left[2]);  // details of blue end here
  const auto split_middle = [&](int64_t y) {
    float *const rest[3] = {left[0].row(y), left[1].row(y), nullptr};
    kernel_.split_middle(rest, rows_at(seen.mf, y), red.row(y), width);
  };
  each_row(split_middle);
  high_blur_.blur(red, seen.hf[0]);
  high_blur_.blur(left[1], seen.hf[1]);
  BorderedPlane active = plane();
  each_row([&](int64_t y) {
    kernel_.split_high(red.row(y), left[1].row(y), rows_at(seen.hf, y), rows_at(seen.uhf, y), width);
    const SeenRows<const float> rows = std::as_const(seen).rows(y);
    kernel_.activity(rows.hf, rows.uhf, width, active.row(y));
  });
  mask_blur_.blur(active, seen.mask);
  seen.rest = {std::move(left[0]), std::move(left[1])};
  return seen;
}

// The mean of the three least of nine values, three pixels apart, weighted; outside the picture is none.
BorderedPlane ButteraugliLevel::eroded(const BorderedPlane &mask) const {
  BorderedPlane found = plane();
  const auto [width, height] = size_;
  each_band(height, threads_, [&, width = width, height = height](int64_t, int64_t begin, int64_t end) {
    std::vector<float> second(size_t(width), 0.0f), third(second);
    for (int64_t y = begin; y < end; ++y) {
      float *const first = found.row(y);
      for (int64_t x = 0; x < width; ++x) first[x] = mask.row(y)[x], second[x] = third[x] = 2 * first[x];
      for (int64_t v = std::max(y % 3, y - 3); v <= std::min(y + 3, height - 1); v += 3)
        for (int64_t by : {-3, 0, 3}) {
          if (v == y && by == 0) continue;
          const float *const row = mask.row(v) + by;
          for (int64_t x = std::max<int64_t>(-by, 0); x < std::min(width, width - by); ++x) {
            float value = row[x];
            const auto keep_less = [&](float &one) {
              const float less = value < one ? value : one;
              value = value < one ? one : value;
              one = less;
            };
            keep_less(first[x]), keep_less(second[x]), keep_less(third[x]);
          }
        }
      for (int64_t x = 0; x < width; ++x) first[x] = 0.45f * first[x] + 0.3f * second[x] + 0.25f * third[x];
    }
  });
  return found;
}

std::array<ButteraugliLevel::MaltaPart, 6> ButteraugliLevel::malta_parts(const SeenPlanes &seen) const {
  constexpr MaltaLines fine = MaltaLines::kFine, coarse = MaltaLines::kCoarse;
  const SeenPlanes &own = original_;
  return {{{&own.mf[0], &seen.mf[0], coarse, {coarse, 8246.75321353, 1009002.70582, 1}},
           {&own.mf[1], &seen.mf[1], coarse, {coarse, 37.0819870399, 130262059.556, 1}},
           {&own.hf[0], &seen.hf[0], coarse, {coarse, 6923.99476109, 8051.15833247, std::sqrt(kAddedShare)}},
           {&own.hf[1], &seen.hf[1], coarse, {coarse, 18.7237414387, 4498534.45232, std::sqrt(kAddedShare)}},
           {&own.uhf[0], &seen.uhf[0], fine, {fine, 173.5, 5.0, kAddedShare}},
           {&own.uhf[1], &seen.uhf[1], fine, {fine, 1.10039032555, 71.7800275169, kAddedShare}}}};
}

void ButteraugliLevel::move(const MaltaPart &part, BorderedPlane &moved) const {
  each_row([&](int64_t y) {
    malta_.move(part.original->row(y), part.seen->row(y), size_.width, part.weights, moved.row(y));
  });
}

void ButteraugliLevel::compare(const SeenPlanes &seen, BorderedPlane &differences) const {
  BorderedPlane lines = plane(), moved = plane();
  lines.clear();
  for (const MaltaPart &part : malta_parts(seen)) {
    move(part, moved);
    each_row([&](int64_t y) { malta_.add(part.lines, moved.row(y), moved.stride(), size_.width, lines.row(y)); });
  }
  each_row([&](int64_t y) {
    kernel_.differences(original(y), seen.rows(y), lines.row(y), size_.width, differences.row(y));
  });
}

// slope: gradient in squared differences of details.
void ButteraugliLevel::pull_malta(const MaltaPart &part, const BorderedPlane &slope, BorderedPlane &moved,
                                  BorderedPlane &to) const {
  move(part, moved);
  const auto [width, height] = size_;
  const int64_t stride = BorderedPlane::stride_of(width), room = kMaxMaltaLines * kMaltaRingRows * stride;
  each_band(height, threads_, [&](int64_t, int64_t begin, int64_t end) {
    const Floats memory = floats(room);
    for (int64_t row = 0; row < kMaxMaltaLines * kMaltaRingRows; ++row) {  // borders
      float *const first = memory.get() + row * stride;
      std::fill_n(first, kBorder, 0.0f);
      std::fill_n(first + kBorder + width, stride - kBorder - width, 0.0f);
    }
    float *const rings = memory.get() + kBorder;
    int64_t next = begin - kMaltaReach;
    for (int64_t y = begin; y < end; ++y) {
      for (; next <= y + kMaltaReach; ++next) {
        if (next >= 0 && next < height) {
          malta_.slopes(part.lines, moved.row(next), moved.stride(), width, slope.row(next), rings, next, stride);
          continue;
        }
        const int64_t slot = (next + kMaltaRingRows) % kMaltaRingRows;
        for (int line = 0; line < kMaxMaltaLines; ++line)
          std::fill_n(rings + (line * kMaltaRingRows + slot) * stride, padded(width), 0.0f);
      }
      malta_.gather(part.lines, rings, y, stride, part.original->row(y), part.seen->row(y), width, part.weights,
                    to.row(y));
    }
  });
}

BorderedPlanes<3> ButteraugliLevel::pull(SeenPlanes seen, BorderedPlane differences, BorderedPlane slope) const {
  const int64_t width = size_.width;
  BorderedPlane moved = plane(), in_mask = plane();
  each_row([&](int64_t y) {
    kernel_.start_gradient(original(y), seen.rows(y), differences.row(y), width, slope.row(y), moved.row(y));
  });
  differences = {};
  in_mask.clear();
  mask_blur_.pull(moved, in_mask);
  const std::array<MaltaPart, 6> parts = malta_parts(seen);
  BorderedPlanes<3> found{plane(), plane(), {}};
  for (size_t c = 0; c < 2; ++c) pull_malta(parts[c], slope, moved, found[c]);
  each_row([&](int64_t y) {
    const float *const lines[2] = {found[0].row(y), found[1].row(y)};
    kernel_.mf_gradient(original(y), slope.row(y), lines, width, rows_at(seen.mf, y));
  });
  BorderedPlanes<2> in_hf = planes<2>(), in_uhf = planes<2>();
  for (size_t c = 0; c < 2; ++c) {
    pull_malta(parts[2 + c], slope, moved, in_hf[c]);
    pull_malta(parts[4 + c], slope, moved, in_uhf[c]);
  }
  each_row([&](int64_t y) {
    const DetailGradients gradients{
        {in_hf[0].row(y), in_hf[1].row(y)}, {in_uhf[0].row(y), in_uhf[1].row(y)}, in_mask.row(y)};
    kernel_.high_gradient(original(y), std::as_const(seen).rows(y), slope.row(y), gradients, width, found[0].row(y),
                          found[1].row(y));
  });
  for (size_t c = 0; c < 2; ++c) high_blur_.pull(in_hf[c], found[c]);
  found[2] = std::move(moved);
  found[2].clear();
  each_row([&](int64_t y) {
    kernel_.suppression_gradient(seen.rest[0].row(y), seen.rest[1].row(y), width, two_rows_at<float>(found, y),
                                 two_rows_at<float>(seen.mf, y));
  });
  for (size_t c = 0; c < 3; ++c) {
    middle_blur_.pull(seen.mf[c], found[c]);
    each_row([&](int64_t y) {
      float *const low = seen.lf[c].row(y);
      const float *const more = found[c].row(y);
      for (int64_t x = 0; x < width; ++x) low[x] -= more[x];
    });
    low_blur_.pull(seen.lf[c], found[c]);
  }
  return found;
}

BorderedPlanes<3> ButteraugliLevel::pull_opsin(const BorderedPlanes<3> &light,
                                               const BorderedPlanes<3> &gradient) const {
  const BorderedPlanes<3> near = around(light);
  BorderedPlanes<3> in_light = planes<3>(), in_around = planes<3>();
  each_row([&](int64_t y) {
    kernel_.opsin_gradient(rows_at(light, y), rows_at(near, y), rows_at(gradient, y), size_.width, rows_at(in_light, y),
                           rows_at(in_around, y));
  });
  for (size_t c = 0; c < 3; ++c) {
    in_around[c].mirror_border(kLightReach);
    light_blur_.pull(in_around[c], in_light[c]);
  }
  return in_light;
}

}  // namespace sgi
