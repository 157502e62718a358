// Drawing, comparing and differentiating a tile in a fit, in vectors of LANES floats.
#include "base/horizontal_sums.hpp"
#include "raster/gradient_kernel.hpp"
#include "raster/tile_drawing.hpp"

namespace sgi {
namespace {

template <int CG>
void backward_group(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int c0,
                    int x0, int y0, const float *grad, float *partials) {
  const float left = x0 + 0.5f, top = y0 + 0.5f;
  for (int64_t i = 0; i < n; ++i) {
    const Splat &s = splats[entries[i].gaussian];
    vf c[CG], all[kMoments + CG] = {};
    broadcast(colours + int64_t(entries[i].gaussian) * channels + c0, c);
    for_each_vector(s, left, [&](int column, float first_dx) {
      const vf dx = columns_from(s, x0 + column);
      vf w{}, wy{}, wyy{};
      for_each_row<Runs::kOfVisit>(s, dx, y0, rows_of(s, first_dx, top), [&](int row, float dy, vf g) {
        const float *at = grad + row * kTileStride + column;
        vf t{};
#pragma GCC unroll 4
        for (int k = 0; k < CG; ++k) {
          const vf up = load(at + k * kTilePlane);
          t = k ? t + up * c[k] : up * c[k];
          all[kMoments + k] += g * up;
        }
        const vf m = g * t;
        w += m;
        wy += m * dy;
        wyy += m * (dy * dy);
      });
      all[0] += w;
      all[1] += w * dx;
      all[2] += w * dx * dx;
      all[3] += wy;
      all[4] += wy * dx;
      all[5] += wyy;
    });
    float sum[kMoments + CG] = {};
    add_sums<kMoments + CG>(all, sum);
    float *out = partials + int64_t(entries[i].slot) * (kMoments + channels);
    for (int j = 0; j < kMoments; ++j) out[j] = c0 == 0 ? sum[j] : out[j] + sum[j];
    for (int k = 0; k < CG; ++k) out[kMoments + c0 + k] = sum[kMoments + k];
  }
}

void backward(const Entry *entries, int64_t n, const Splat *splats, const float *colours, int channels, int x0, int y0,
              const float *grad, float *partials) {
  for_each_group(channels, [&](int c, auto group) {
    backward_group<decltype(group)::value>(entries, n, splats, colours, channels, c, x0, y0, grad + c * kTilePlane,
                                           partials);
  });
}

// Clears what of a row of a tile lies outside the view; the part inside is [begin, end).
inline void clear_outside(float *row, int begin, int end) {
  for (int x = 0; x < begin; ++x) row[x] = 0.0f;
  for (int x = end; x < kTileStride; ++x) row[x] = 0.0f;
}

template <Loss LOSS, bool WEIGHTED>
Errors compare_as(float *tile, int channels, const TileRect &r, const Comparison &with, int64_t width, int64_t height) {
  constexpr bool kSquared = LOSS == Loss::kSquared;
  const float weight = kSquared ? 2.0f * with.weight : with.weight;
  Errors total{};
  for (int c = 0; c < channels; ++c) {
    vf loss{}, squared{};
    for (int y = 0; y < kTileHeight; ++y) {
      float *row = tile + c * kTilePlane + y * kTileStride;
      const bool inside = y >= r.row0 && y < r.row1;
      const int begin = inside ? r.col0 : kTileStride, end = inside ? r.col1 : kTileStride;
      clear_outside(row, begin, end);
      if (!inside) continue;
      const float *wanted = with.target + (c * height + r.y + y) * width + r.x;
      const float *w = WEIGHTED ? with.weights + (r.y + y) * width + r.x : nullptr;
      int x = begin;
      for (; x + LANES <= end; x += LANES) {
        const vf error = load(row + x) - load(wanted + x), size = kSquared ? error : absv(error);
        squared += error * error;
        const vf slope = kSquared ? error : signv(error);
        if constexpr (WEIGHTED) {
          const vf scaled = load(w + x) * size;
          loss += kSquared ? scaled * error : scaled;
          store(row + x, weight * (load(w + x) * slope));
        } else {
          if constexpr (!kSquared) loss += size;
          store(row + x, weight * slope);
        }
      }
      float rest = 0, rest_squared = 0;
      for (; x < end; ++x) {
        const float error = row[x] - wanted[x], own = WEIGHTED ? w[x] : 1.0f;
        rest_squared += error * error;
        rest += own * (kSquared ? error * error : absv(error));
        row[x] = weight * (own * (kSquared ? error : signv(error)));
      }
      total.squared += rest_squared;
      total.loss += rest;
    }
    for (int i = 0; i < LANES; ++i) {
      total.squared += squared[i];
      total.loss += loss[i];
    }
  }
  if (kSquared && !WEIGHTED) total.loss = total.squared;
  return total;
}

Errors compare(float *tile, int channels, const TileRect &r, const Comparison &with, int64_t width, int64_t height) {
  if (with.loss == Loss::kSquared)
    return (with.weights ? compare_as<Loss::kSquared, true> : compare_as<Loss::kSquared, false>)(tile, channels, r,
                                                                                                 with, width, height);
  return (with.weights ? compare_as<Loss::kAbsolute, true> : compare_as<Loss::kAbsolute, false>)(tile, channels, r,
                                                                                                 with, width, height);
}

}  // namespace

const GradientKernel GradientKernel::SGI_ISA{draw_tile<Runs::kOfVisit>, sgi::compare, sgi::backward};

}  // namespace sgi
