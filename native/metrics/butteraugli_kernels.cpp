#include "metrics/butteraugli_kernel.hpp"
#include "metrics/maps.hpp"
#include "metrics/rows.hpp"

namespace sgi {
namespace {

constexpr float kIntensity = 80;  // nits of white
// What cones take of linear light in nits, and what each gives at least.
constexpr float kMix[3][3] = {
    {kIntensity * 0.29956550340058319f, kIntensity * 0.63373087833825936f, kIntensity * 0.077705617820981968f},
    {kIntensity * 0.22158691104574774f, kIntensity * 0.69391388044116142f, kIntensity * 0.0987313588422f},
    {kIntensity * 0.02f, kIntensity * 0.02f, kIntensity * 0.20480129041026129f}};
constexpr float kBias[3] = {1.7557483643287353f, 1.7557483643287353f, 12.226454707163354f};
// Their gain falls with the light around: (kGain log(a + kGainBias) - kGainLess) / a.
constexpr float kGain = 19.245013259874995f, kGainBias = 9.9710635769299145f, kGainLess = 23.16046239805755f;
constexpr float kMinGain = 1e-4f, kLog2 = 0.69314718056f;

constexpr float kLow[3] = {32.22174835205078f, 13.769779205322266f, 47.504615783691406f};  // scales of lf
constexpr float kBlueLess = 0.362267051518f;
constexpr float kMiddleDead = 0.29f, kMiddleRange = 0.1f;
constexpr float kSuppressed = 0.653020556257f, kSuppression = 46 * (1 - kSuppressed), kBrightness = 46;
constexpr float kHighDead = 1.5f, kHighScale = 2.155f, kHighRange = 0.132f, kHighMost = 28.4691806922f;
constexpr float kUltraDead = 0.04f, kUltraScale = 2.69313763794f, kUltraMost = 5.19175294647f;
constexpr float kCompressed = 0.724216145665f;  // slope beyond the most
constexpr float kMaskRed = 2.5f * 2.5f, kMaskBright = 0.4f * 0.4f;
constexpr float kMaskFactor = 6.19424080439f, kMaskBias = 12.61050594197f * kMaskFactor, kMinActivity = 1e-16f;
constexpr float kMaskWeight = 10;
constexpr float kAddedShare = 0.8f;  // how much less it counts that something is added at high frequencies
constexpr float kHfWeight[2] = {0.8f * 400.0f, 0.8f * 1.50815703118f};
constexpr float kMfWeight[3] = {2150.0f, 10.6195433239f, 16.2176043152f};
constexpr float kLfWeight[3] = {29.2353797994f, 0.844626970982f, 0.703646627719f};
constexpr float kOutsideLeast = 0.4f, kOutsideMost = 1.0f;
constexpr float kMinDifference = 1e-12f;  // squared

// 1 / (17.8 log 80 / log 255)
constexpr float kScale = 0.07104177283541442f;

vf floored(vf v, float least) { return maxv(v, vf{} + least); }

vf shrunk(vf v, float dead) { return maxv(v - dead, vf{}) + minv(v + dead, vf{}); }

vf amplified(vf v, float range) { return v + clampv(v, range); }

vf compressed(vf v, float most) { return kCompressed * v + (1 - kCompressed) * clampv(v, most); }

// How far v lies outside kOutsideLeast to kOutsideMost times `original`, as what is to be added to it.
vf outside(vf original, vf v) {
  const vf a = kOutsideLeast * original, b = kOutsideMost * original;
  return minv(maxv(v, minv(a, b)), maxv(a, b)) - v;
}

struct Cone {
  vf light, adapted, gain, seen;

  Cone(int i, const vf (&at)[3], const vf (&around)[3]) {
    const float *mix = kMix[i];
    light = mix[0] * at[0] + mix[1] * at[1] + mix[2] * at[2] + kBias[i];
    adapted = floored(mix[0] * around[0] + mix[1] * around[1] + mix[2] * around[2] + kBias[i], kBias[i]);
    gain = (kGain * kLog2 * log2v(adapted + kGainBias) - kGainLess) / adapted;
    seen = light * floored(gain, kMinGain);
  }
};

void load_three(const float *const rows[3], int64_t x, vf (&to)[3]) {
  for (int c = 0; c < 3; ++c) to[c] = load(rows[c] + x);
}

void opsin(const float *const light[3], const float *const around[3], int64_t width, float *const out[3]) {
  for (int64_t x = 0; x < width; x += LANES) {
    vf at[3], near[3], cones[3];
    load_three(light, x, at), load_three(around, x, near);
    for (int i = 0; i < 3; ++i) cones[i] = floored(Cone(i, at, near).seen, kBias[i]);
    const vi live = inside(x, width);
    store(out[0] + x, zero_unless(live, cones[0] - cones[1]));
    store(out[1] + x, zero_unless(live, cones[0] + cones[1]));
    store(out[2] + x, zero_unless(live, cones[2]));
  }
}

void opsin_gradient(const float *const light[3], const float *const around[3], const float *const gradient[3],
                    int64_t width, float *const in_light[3], float *const in_around[3]) {
  for (int64_t x = 0; x < width; x += LANES) {
    vf at[3], near[3], given[3], to_light[3] = {}, to_around[3] = {};
    load_three(light, x, at), load_three(around, x, near), load_three(gradient, x, given);
    const vf in_cone[3] = {given[1] + given[0], given[1] - given[0], given[2]};
    for (int i = 0; i < 3; ++i) {
      const Cone cone(i, at, near);
      const vf slope = zero_unless(cone.seen > kBias[i], in_cone[i]);
      const vf lit = slope * floored(cone.gain, kMinGain);
      const vf in_gain = zero_unless((cone.gain > kMinGain) & (cone.adapted > kBias[i]), slope * cone.light);
      const vf adapted = in_gain * (kGain / (cone.adapted + kGainBias) - cone.gain) / cone.adapted;
      for (int c = 0; c < 3; ++c) to_light[c] += kMix[i][c] * lit, to_around[c] += kMix[i][c] * adapted;
    }
    const vi live = inside(x, width);
    for (int c = 0; c < 3; ++c) {
      store(in_light[c] + x, zero_unless(live, to_light[c]));
      store(in_around[c] + x, zero_unless(live, to_around[c]));
    }
  }
}

void split_low(float *const opsin[3], float *const lf[3], int64_t width) {
  for (int64_t x = 0; x < width; x += LANES) {
    vf low[3];
    load_three(lf, x, low);
    for (int c = 0; c < 3; ++c) store(opsin[c] + x, load(opsin[c] + x) - low[c]);
    store(lf[0] + x, kLow[0] * low[0]);
    store(lf[1] + x, kLow[1] * low[1]);
    store(lf[2] + x, kLow[2] * (low[2] - kBlueLess * low[1]));
  }
}

vf suppression(vf bright) { return kSuppressed + kSuppression / (bright * bright + kBrightness); }

void split_middle(float *const rest[3], float *const mf[3], float *red, int64_t width) {
  for (int64_t x = 0; x < width; x += LANES) {
    vf middle[3];
    load_three(mf, x, middle);
    const vf first = load(rest[0] + x) - middle[0], bright = load(rest[1] + x) - middle[1];
    store(rest[0] + x, first);
    store(rest[1] + x, bright);
    store(red + x, first * suppression(bright));
    store(mf[0] + x, shrunk(middle[0], kMiddleDead));
    store(mf[1] + x, amplified(middle[1], kMiddleRange));
  }
}

void split_high(const float *red, const float *bright, float *const hf[2], float *const uhf[2], int64_t width) {
  for (int64_t x = 0; x < width; x += LANES) {
    const vf high = load(hf[0] + x), raw = compressed(load(hf[1] + x), kHighMost);
    store(uhf[0] + x, shrunk(load(red + x) - high, kUltraDead));
    store(uhf[1] + x, kUltraScale * compressed(load(bright + x) - raw, kUltraMost));
    store(hf[0] + x, shrunk(high, kHighDead));
    store(hf[1] + x, amplified(kHighScale * raw, kHighRange));
  }
}

// How much of red against green, and of brightness, lies at a pixel.
struct Activity {
  vf red, bright, value;

  Activity(const float *const hf[2], const float *const uhf[2], int64_t x)
      : red(load(hf[0] + x) + load(uhf[0] + x)), bright(load(hf[1] + x) + load(uhf[1] + x)),
        value(rootv(floored(kMaskRed * red * red + kMaskBright * bright * bright, kMinActivity))) {}
  vf root() const { return rootv(kMaskFactor * value + kMaskBias); }
};

void activity(const float *const hf[2], const float *const uhf[2], int64_t width, float *activity) {
  const vf none = rootv(vf{} + kMaskBias);
  for (int64_t x = 0; x < width; x += LANES)
    store(activity + x, zero_unless(inside(x, width), Activity(hf, uhf, x).root() - none));
}

void visibility(const float *eroded, int64_t width, float *details, float *ground) {
  for (int64_t x = 0; x < width; x += LANES) {
    const vf mask = load(eroded + x);
    const vf one = kScale * (1.0f + 2.5485944793f / (0.451936922203f * mask + 0.829591754942f));
    const vf other = kScale * (1.0f + 0.505054525019f / (3.87449418804f * mask + 0.20025578522f));
    store(details + x, one * one);
    store(ground + x, other * other);
  }
}

vf apart(const float *seen, const float *original, int64_t x) { return load(seen + x) - load(original + x); }

void differences(const OriginalRows &original, const SeenRows<const float> &seen, const float *lines, int64_t width,
                 float *out) {
  const SeenRows<const float> &own = original.seen;
  for (int64_t x = 0; x < width; x += LANES) {
    const vf mask = apart(seen.mask, own.mask, x);
    vf details = load(lines + x) + kMaskWeight * mask * mask, ground{};
    for (int c = 0; c < 2; ++c) {
      const vf moved = apart(seen.hf[c], own.hf[c], x), lost = outside(load(own.hf[c] + x), load(seen.hf[c] + x));
      details += kHfWeight[c] * (kAddedShare * moved * moved + 1 / kAddedShare * lost * lost);
    }
    for (int c = 0; c < 3; ++c) {
      const vf middle = apart(seen.mf[c], own.mf[c], x), low = apart(seen.lf[c], own.lf[c], x);
      details += kMfWeight[c] * middle * middle;
      ground += kLfWeight[c] * low * low;
    }
    const vf sum = load(original.details + x) * details + load(original.ground + x) * ground;
    store(out + x, rootv(floored(sum, kMinDifference)));
  }
}

void start_gradient(const OriginalRows &original, const SeenRows<float> &seen, const float *differences, int64_t width,
                    float *slope, float *mask) {
  const SeenRows<const float> &own = original.seen;
  for (int64_t x = 0; x < width; x += LANES) {
    const vi live = inside(x, width);
    const vf squared = zero_unless(live, load(slope + x) / floored(2.0f * load(differences + x), 1e-6f));
    const vf details = squared * load(original.details + x), ground = squared * load(original.ground + x);
    store(slope + x, details);
    store(mask + x, 2 * kMaskWeight * details * apart(seen.mask, own.mask, x));
    vf low[3];
    for (int c = 0; c < 3; ++c) low[c] = 2 * kLfWeight[c] * kLow[c] * ground * apart(seen.lf[c], own.lf[c], x);
    store(seen.lf[0] + x, low[0]);
    store(seen.lf[1] + x, low[1] - kBlueLess * low[2]);
    store(seen.lf[2] + x, low[2]);
  }
}

void mf_gradient(const OriginalRows &original, const float *slope, const float *const lines[2], int64_t width,
                 float *const mf[3]) {
  for (int64_t x = 0; x < width; x += LANES) {
    vf middle[3], found[3];
    load_three(mf, x, middle);
    for (int c = 0; c < 3; ++c) {
      found[c] = 2 * kMfWeight[c] * load(slope + x) * (middle[c] - load(original.seen.mf[c] + x));
      if (c < 2) found[c] += load(lines[c] + x);
    }
    store(mf[0] + x, zero_unless(absv(middle[0]) > 0.0f, found[0]));
    store(mf[1] + x, select(absv(middle[1]) < 2 * kMiddleRange, 2.0f * found[1], found[1]));
    store(mf[2] + x, found[2]);
  }
}

void high_gradient(const OriginalRows &original, const SeenRows<const float> &seen, const float *slope,
                   const DetailGradients &gradients, int64_t width, float *in_red, float *in_bright) {
  for (int64_t x = 0; x < width; x += LANES) {
    const vf w = load(slope + x);
    const Activity active(seen.hf, seen.uhf, x);
    const vf in_squares = load(gradients.mask + x) * (0.5f * kMaskFactor) / (active.root() * active.value);
    vf high[2], ultra[2];
    for (int c = 0; c < 2; ++c) {
      const vf own = load(original.seen.hf[c] + x), hf = load(seen.hf[c] + x);
      const vf in_mask = in_squares * (c ? kMaskBright * active.bright : kMaskRed * active.red);
      high[c] = load(gradients.hf[c] + x) + in_mask +
                2 * kHfWeight[c] * w * (kAddedShare * (hf - own) - 1 / kAddedShare * outside(own, hf));
      ultra[c] = load(gradients.uhf[c] + x) + in_mask;
    }
    const vf hf = load(seen.hf[1] + x);
    const vf red = zero_unless(absv(load(seen.uhf[0] + x)) > 0.0f, ultra[0]);
    vf bright = kUltraScale * ultra[1];
    bright = select(absv(load(seen.uhf[1] + x)) < kUltraScale * kUltraMost, bright, kCompressed * bright);
    vf raw = select(absv(hf) < 2 * kHighRange, 2 * kHighScale * high[1], kHighScale * high[1]) - bright;
    raw = select(absv(hf) < kHighScale * kHighMost + kHighRange, raw, kCompressed * raw);
    store(in_red + x, red);
    store(in_bright + x, bright);
    store(gradients.hf[0] + x, zero_unless(absv(load(seen.hf[0] + x)) > 0.0f, high[0]) - red);
    store(gradients.hf[1] + x, raw);
  }
}

void suppression_gradient(const float *rest_red, const float *rest_bright, int64_t width, float *const gradient[2],
                          float *const mf[2]) {
  for (int64_t x = 0; x < width; x += LANES) {
    const vf bright = load(rest_bright + x), squares = bright * bright + kBrightness, red = load(gradient[0] + x);
    const vf less = red * load(rest_red + x) * (2 * kSuppression) * bright / (squares * squares);
    const vf found[2] = {red * suppression(bright), load(gradient[1] + x) - less};
    for (int c = 0; c < 2; ++c) {
      store(gradient[c] + x, found[c]);
      store(mf[c] + x, load(mf[c] + x) - found[c]);
    }
  }
}

}  // namespace

const ButteraugliKernel ButteraugliKernel::SGI_ISA{sgi::opsin,        sgi::opsin_gradient, sgi::split_low,
                                                   sgi::split_middle, sgi::split_high,     sgi::activity,
                                                   sgi::visibility,   sgi::differences,    sgi::start_gradient,
                                                   sgi::mf_gradient,  sgi::high_gradient,  sgi::suppression_gradient};

}  // namespace sgi
