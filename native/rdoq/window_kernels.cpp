// Runs of rows begin at a window's first row: they need not agree with what a decoder draws.
#include "base/vector.hpp"
#include "rdoq/window_kernel.hpp"

namespace sgi {
namespace {

static_assert(kWindowPadding % LANES == 0, "a working row must hold whole vectors");

// G in LANES columns, row by row.
struct Column {
  const Splat &s;
  Heights<vf> heights;

  Column(const Splat &splat, float left) : s(splat), heights(splat, iota() + (left + 0.5f - splat.x)) {}
  void start(int row) { heights.start(s, row); }
  void next() { heights.next(s); }
  const vf &g() const { return heights.g; }
};

inline int least(int a, int b) { return a < b ? a : b; }

// The first `count` lanes of v, zero in the others.
inline vf first_lanes(vf v, int count) {
  return count >= LANES ? v : (vf)((vi)v & (vi)(iota() < static_cast<float>(count)));
}

inline float sum_of(vf v) {
  float sum = 0;
  for (int i = 0; i < LANES; ++i) sum += v[i];
  return sum;
}

void draw(const Splat &s, const Window &w, float *out) {
  for (int x = 0; x < w.width; x += LANES) {
    Column column(s, w.x + x);
    for (int row = 0; row < w.height;) {
      column.start(w.y + row);
      for (const int stop = least(row + s.span, w.height); row < stop; ++row, column.next())
        store(out + int64_t(row) * w.stride + x, first_lanes(column.g(), w.width - x));
    }
  }
}

void add_scaled(const Plane &p, const Window &w, float factor, float *out) {
  for (int row = 0; row < w.height; ++row)
    for (int x = 0; x < w.width; x += LANES) {
      float *to = out + int64_t(row) * w.stride + x;
      store(to, load(to) + factor * load(p.first + row * p.row + x));
    }
}

float inner(const Plane &p, const Window &w, const float *g) {
  vf sum{};
  for (int row = 0; row < w.height; ++row)
    for (int x = 0; x < w.width; x += LANES)
      sum += load(p.first + row * p.row + x) * load(g + int64_t(row) * w.stride + x);
  return sum_of(sum);
}

void subtract(const Plane &p, const Window &w, float factor, const float *g) {
  for (int row = 0; row < w.height; ++row)
    for (int x = 0; x < w.width; x += LANES) {
      float *to = p.first + row * p.row + x;
      store(to, load(to) - factor * load(g + int64_t(row) * w.stride + x));
    }
}

void weigh(const WeightPlane &weights, const Window &w, const float *g, float *out) {
  for (int row = 0; row < w.height; ++row)
    for (int x = 0; x < w.width; x += LANES) {
      const int64_t at = int64_t(row) * w.stride + x;
      store(out + at, load(weights.first + row * weights.row + x) * load(g + at));
    }
}

// Two at once hide each other's latency and share what is loaded.
template <bool kWeighted>
inline __attribute__((always_inline)) void changes_of(const Splat *two, const Window &w, const WeightPlane &weights,
                                                      float power, const float *mixed, const float *g, float *out) {
  const int span = least(two[0].span, two[1].span);
  vf total[2] = {};
  for (int x = 0; x < w.width; x += LANES) {
    Column a(two[0], w.x + x), b(two[1], w.x + x);
    vf sum[2] = {};
    for (int row = 0; row < w.height;) {
      a.start(w.y + row);
      b.start(w.y + row);
      for (const int stop = least(row + span, w.height); row < stop; ++row, a.next(), b.next()) {
        const int64_t at = int64_t(row) * w.stride + x;
        const vf old = load(g + at), twice = 2.0f * load(mixed + at);
        vf da = a.g() - old, db = b.g() - old;
        const vf slope_a = power * da - twice, slope_b = power * db - twice;
        if constexpr (kWeighted) {
          const vf weight = load(weights.first + row * weights.row + x);
          da *= weight;
          db *= weight;
        }
        sum[0] += da * slope_a;
        sum[1] += db * slope_b;
      }
    }
    for (int i = 0; i < 2; ++i) total[i] += first_lanes(sum[i], w.width - x);
  }
  for (int i = 0; i < 2; ++i) out[i] = sum_of(total[i]);
}

void changes(const Splat *two, const Window &w, float power, const float *mixed, const float *g, float *out) {
  changes_of<false>(two, w, {}, power, mixed, g, out);
}

void weighted_changes(const Splat *two, const Window &w, const WeightPlane &weights, float power, const float *mixed,
                      const float *g, float *out) {
  changes_of<true>(two, w, weights, power, mixed, g, out);
}

}  // namespace

const WindowKernel WindowKernel::SGI_ISA{sgi::draw,  sgi::add_scaled, sgi::inner,           sgi::subtract,
                                         sgi::weigh, sgi::changes,    sgi::weighted_changes};

}  // namespace sgi
