#include "base/inline.hpp"
#include "base/vector.hpp"
#include "image/regular_pattern_kernel.hpp"

namespace sgi {
namespace {

constexpr int kHalf = kPatternWindow / 2;

// Cosines, then sines of a window's samples, which are even and odd about its middle. at(i): sample i.
template <class At>
SGI_INLINE void transform(const float *waves, At at, vf *out) {
  vf even[kHalf], odd[kHalf];
  for (int i = 0; i < kHalf; ++i) {
    const vf after = at(kHalf + i), before = at(kHalf - 1 - i);
    even[i] = after + before, odd[i] = after - before;
  }
  for (int k = 0; k < kPatternWaves; ++k) {
    const float *cosine = waves + k * kHalf, *sine = cosine + kPatternWaves * kHalf;
    vf c{}, s{};
    for (int i = 0; i < kHalf; ++i) c += cosine[i] * even[i], s += sine[i] * odd[i];
    out[k] = c, out[kPatternWaves + k] = s;
  }
}

using Waves = vf[2 * kPatternWaves];

// Power [kPatternFrequencies] of windows about their means, from waves along their rows, `first` the upper one of a
// ring; that of a pattern sums to its variance.
void find_power(const float *waves, const Waves *ring, int first, vf *power) {
  float sums[kPatternWaves];  // of cosines; those of sines are 0
  for (int k = 0; k < kPatternWaves; ++k) {
    sums[k] = 0;
    for (int i = 0; i < kHalf; ++i) sums[k] += 2 * waves[k * kHalf + i];
  }
  vf level{};
  for (int u = 0; u < kPatternWaves; ++u) {
    Waves of_cosine, of_sine;
    const auto row = [&](int i) { return (first + i) % kPatternWindow; };
    transform(waves, [&](int i) { return ring[row(i)][u]; }, of_cosine);
    transform(waves, [&](int i) { return ring[row(i)][kPatternWaves + u]; }, of_sine);
    if (u == 0) level = of_cosine[0] / (sums[0] * sums[0]);
    for (int v = 0; v < kPatternWaves; ++v) {
      const vf cc = of_cosine[v] - sums[u] * sums[v] * level, sc = of_cosine[kPatternWaves + v];
      const vf cs = of_sine[v], ss = of_sine[kPatternWaves + v];
      const vf along = (cc - ss) * (cc - ss) + (cs + sc) * (cs + sc);
      const vf against = (cc + ss) * (cc + ss) + (cs - sc) * (cs - sc);
      constexpr float kScale = 2.0f / (kPatternWindow * kPatternWindow);
      power[v * kPatternWaves + u] = kScale * along;
      power[kPatternFrequencies / 2 + v * kPatternWaves + u] = kScale * against;
    }
  }
}

SGI_INLINE vf sum_of(const vf *power, const int32_t *from, const int32_t *to) {
  vf sum{};
  for (; from != to; ++from) sum += power[*from];
  return sum;
}

bool any(vi mask) {
  int32_t found = 0;
  for (int i = 0; i < LANES; ++i) found |= mask[i];
  return found != 0;
}

void tell(const Patterns &patterns, const vf *power, float *ratio, float *strength, int32_t *number) {
  const float least = patterns.doubtful * patterns.noise;
  vf best{}, best_own{};
  vi best_number{};
  int32_t own_begin = 0, others_begin = 0;
  for (int p = 0; p < patterns.count; ++p) {
    const int32_t own_end = patterns.own_end[p], others_end = patterns.others_end[p];
    const vf own = sum_of(power, patterns.own + own_begin, patterns.own + own_end);
    if (any(own > least)) {
      const vf others = sum_of(power, patterns.others + others_begin, patterns.others + others_end);
      const vf here = own / (others + patterns.noise);
      const vi better = here > best;
      best = select(better, here, best), best_own = select(better, own, best_own);
      best_number = (better & p) | (~better & best_number);
    }
    own_begin = own_end, others_begin = others_end;
  }
  store(ratio, select(best > patterns.doubtful, best, vf{}));
  store(strength, best_own);
  for (int i = 0; i < LANES; ++i) number[i] = best_number[i];
}

void find_column(const Patterns &patterns, const float *plane, int64_t stride, int64_t rows, float *ratio, float *power,
                 int32_t *number) {
  Waves ring[kPatternWindow];
  vf found[kPatternFrequencies];
  for (int64_t row = 0; row < rows; ++row) {
    const int64_t top = row * kPatternBlock;
    for (int64_t y = row ? top + kPatternWindow - kPatternBlock : 0; y < top + kPatternWindow; ++y)
      transform(
          patterns.waves,
          [&](int x) {
            vf v;
            for (int i = 0; i < LANES; ++i) set_lane(v, i, plane[y * stride + i * kPatternBlock + x]);
            return v;
          },
          ring[y % kPatternWindow]);
    find_power(patterns.waves, ring, int(top % kPatternWindow), found);
    tell(patterns, found, ratio + row * LANES, power + row * LANES, number + row * LANES);
  }
}

}  // namespace

const RegularPatternKernel RegularPatternKernel::SGI_ISA{find_column};

}  // namespace sgi
