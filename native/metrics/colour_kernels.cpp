#include "base/elementary.hpp"
#include "metrics/colour_kernel.hpp"
#include "metrics/maps.hpp"
#include "metrics/rows.hpp"

namespace sgi {
namespace {

// Opsin absorbance of libjxl: what L, M and S cones take of linear R, G and B; and the cube root of its bias.
constexpr float kAbsorbance[3][3] = {{0.30f, 0.622f, 0.078f},
                                     {0.23f, 0.692f, 0.078f},
                                     {0.24342268924547819f, 0.20476744424496821f, 0.55180986650955360f}};
constexpr float kBias = 0.0037930732552754493f, kBiasRoot = 0.15595420054924863f;
// XYB is moved so that all three are positive.
constexpr float kXScale = 14.0f, kX = 0.42f, kY = 0.01f, kB = 0.55f;

constexpr float kKnee = 0.04045f, kSlope = 1 / 12.92f, kOffset = 0.055f, kPower = 2.4f;  // of sRGB

vf curved(vf s) { return exp2v(kPower * log2v((s + kOffset) * (1 / (1 + kOffset)))); }

void linearize(const float *samples, int64_t width, float *linear) {
  for (int64_t x = 0; x < width; x += LANES) {
    const vf s = minv(maxv(load_some(samples + x, count_left(x, width)), vf{}), vf{} + 1.0f);
    store(linear + x, select(s > kKnee, curved(s), s * kSlope));
  }
}

vf root_of(const float (&row)[3], vf r, vf g, vf b) {
  const vf absorbed = row[0] * r + row[1] * g + row[2] * b + kBias, inverse = inverse_cube_root(absorbed);
  return absorbed * inverse * inverse;
}

void to_xyb(const float *const linear[3], const float *const less[3], int64_t width, float *const xyb[3]) {
  for (int64_t x = 0; x < padded(width); x += LANES) {
    const vi live = inside(x, width);
    vf rgb[3];
    for (int c = 0; c < 3; ++c) rgb[c] = zero_unless(live, load(linear[c] + x));
    const vf l = root_of(kAbsorbance[0], rgb[0], rgb[1], rgb[2]);
    const vf m = root_of(kAbsorbance[1], rgb[0], rgb[1], rgb[2]);
    const vf s = root_of(kAbsorbance[2], rgb[0], rgb[1], rgb[2]);
    const vf y = 0.5f * (l + m);
    const vf found[3] = {0.5f * kXScale * (l - m) + kX, y + (kY - kBiasRoot), s - y + kB};
    for (int c = 0; c < 3; ++c) store(xyb[c] + x, zero_unless(live, less ? found[c] - load(less[c] + x) : found[c]));
  }
}

void halve(const float *row, const float *below, int64_t width, float *half) {
  if (!below) below = row;
  for (int64_t x = 0; x < width / 2; ++x)
    half[x] = 0.25f * ((row[2 * x] + row[2 * x + 1]) + (below[2 * x] + below[2 * x + 1]));
  if (width % 2) half[width / 2] = 0.5f * (row[width - 1] + below[width - 1]);
}

void to_linear_gradient(const float *const reference[3], const float *const difference[3],
                        const float *const gradient[3], int64_t width, float *const linear[3]) {
  for (int64_t x = 0; x < width; x += LANES) {
    vf xyb[3], g[3];
    for (int c = 0; c < 3; ++c) {
      xyb[c] = load(reference[c] + x) + load(difference[c] + x);
      g[c] = load(gradient[c] + x);
    }
    const vf y = xyb[1] - (kY - kBiasRoot), half = (xyb[0] - kX) * (1 / kXScale), level = 0.5f * (g[1] - g[2]);
    const vf roots[3] = {y + half, y - half, xyb[2] - kB + y};
    const vf cones[3] = {0.5f * kXScale * g[0] + level, level - 0.5f * kXScale * g[0], g[2]};
    vf absorbed[3];  // a root's derivative is 1 / (3 root^2)
    for (int i = 0; i < 3; ++i) absorbed[i] = cones[i] / (3.0f * roots[i] * roots[i]);
    for (int c = 0; c < 3; ++c)
      store(linear[c] + x,
            kAbsorbance[0][c] * absorbed[0] + kAbsorbance[1][c] * absorbed[1] + kAbsorbance[2][c] * absorbed[2]);
  }
}

void add_doubled(const float *half, int rows, int64_t width, float *gradient) {
  const float share = 0.5f / float(rows);
  for (int64_t x = 0; x < width / 2; ++x) {
    gradient[2 * x] += share * half[x];
    gradient[2 * x + 1] += share * half[x];
  }
  if (width % 2) gradient[width - 1] += 2 * share * half[width / 2];
}

void to_sample_gradient(const float *samples, const float *linear_gradient, int64_t width, float *gradient) {
  for (int64_t x = 0; x < width; x += LANES) {
    const int count = count_left(x, width);
    const vf s = load_some(samples + x, count), clipped = minv(maxv(s, vf{}), vf{} + 1.0f);
    const vf slope = select(clipped > kKnee, kPower * curved(clipped) / (clipped + kOffset), vf{} + kSlope);
    store_some(gradient + x, zero_unless(s == clipped, load(linear_gradient + x) * slope), count);
  }
}

}  // namespace

const ColourKernel ColourKernel::SGI_ISA{sgi::linearize,          sgi::to_xyb,      sgi::halve,
                                         sgi::to_linear_gradient, sgi::add_doubled, sgi::to_sample_gradient};

}  // namespace sgi
