// The paper profile's step but for its networks, a thread for each seed; native/fit computes.
#pragma once
#define LANES 1  // of the vectors that native/fit computes with: a thread has a seed
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"
#include "fit/feature_seeds.hpp"

namespace sgi {

constexpr int kFeatureThreads = 64;

namespace {

// Calls visit(seed) for the seed of every thread.
template <int THREADS, class Arguments, class Visit>
inline void for_each_seed(const ThreadBlock<THREADS> &block, const Arguments &a, Visit visit) {
  block.each([&](int t) {
    const int seed = block.index() * THREADS + t;
    if (seed < a.count) visit(seed);
  });
}

inline FeatureState feature_state_of(const FeatureArguments &a) {
  FeatureState s{};
  s.per_seed = a.per_seed;
  s.channels = a.channels;
  s.features = a.features;
  s.hidden = a.hidden;
  s.context_hidden = a.context_hidden;
  s.hash_features = a.resolutions * a.entry_features;
  s.count = a.count;
  s.half_pixels = a.half_pixels;
  s.steps = a.steps;
  s.entry = a.entry;
  s.weight = a.weight;
  s.theta = a.theta;
  s.signs = a.signs;
  s.resolutions = a.resolutions;
  s.entry_features = a.entry_features;
  s.scale = a.scale;
  s.rounding = Rounding(a.rounding);
  s.priced = a.priced != 0;
  s.key = a.key;
  s.mirror = a.mirror;
  s.share = a.share;
  return s;
}

// A seed's column of rows that lie `count` apart. Who only reads them takes those that do not change, too.
inline SeedRows rows_of(const FeatureArguments &a, const float *rows, int seed) {
  return {const_cast<float *>(rows) + seed, a.count};
}

// What a seed has in an array [N, width].
inline SeedRows of_seed(const float *values, int width, int seed) {
  return {const_cast<float *>(values) + int64_t(seed) * width, 1};
}

inline SeedPlace place_of(const FeatureArguments &a, const FeatureState &s, int seed) {
  return SeedPlace(s, seed, rows_of(a, a.drawn, seed), rows_of(a, a.said_shape, seed));
}

}  // namespace

// Inputs of MLP_p from H, behind those that are the same for all seeds.
SGI_KERNEL(read_hash, kFeatureThreads, FeatureArguments) {
  const FeatureState s = feature_state_of(a);
  for_each_seed(block, a, [&](int seed) {
    const SeedRows inputs = rows_of(a, a.inputs, seed).from(kLevelInputs);
    for (int r = 0; r < s.resolutions; ++r)
      see_signs<0>(s, seed, r, inputs.from(r * s.entry_features).at, inputs.pitch);
  });
}

// Values as they are coded and as they are drawn, and bits.
SGI_KERNEL(draw_features, kFeatureThreads, FeatureArguments) {
  const FeatureState s = feature_state_of(a);
  for_each_seed(block, a, [&](int seed) {
    const SeedRows trained = rows_of(a, a.trained, seed), values = rows_of(a, a.values, seed);
    for (int j = 0; j < s.attributes(); ++j) values.set(j, coded_value(s, j, trained.get(j)));
    a.bits[seed] = draw_values(s, seed, values, rows_of(a, a.said_context, seed), rows_of(a, a.drawn, seed),
                               BitRows(s, rows_of(a, a.bit_rows, seed)));
  });
}

SGI_KERNEL(write_feature_gaussians, kFeatureThreads, FeatureArguments) {
  const FeatureState s = feature_state_of(a);
  for_each_seed(block, a, [&](int seed) {
    place_gaussians(s, place_of(a, s, seed), of_seed(a.means, 2 * s.per_seed, seed),
                    of_seed(a.covariances, 3 * s.per_seed, seed));
    const SeedRows said = rows_of(a, a.said_colour, seed), colours = of_seed(a.colours, s.colours(), seed);
    for (int i = 0; i < s.colours(); ++i) colours.set(i, said.get(i));
  });
}

// From gradients of Gaussians to those of what MLP_c and MLP_Sigma said, of scales and of offsets.
SGI_KERNEL(read_feature_slopes, kFeatureThreads, FeatureArguments) {
  const FeatureState s = feature_state_of(a);
  for_each_seed(block, a, [&](int seed) {
    descend_gaussians(s, place_of(a, s, seed), of_seed(a.grad_means, 2 * s.per_seed, seed),
                      of_seed(a.grad_covariances, 3 * s.per_seed, seed), rows_of(a, a.up_shape, seed),
                      rows_of(a, a.slopes, seed));
    const SeedRows up = rows_of(a, a.up_colour, seed), colours = of_seed(a.grad_colours, s.colours(), seed);
    for (int i = 0; i < s.colours(); ++i) up.set(i, colours.get(i));
  });
}

// From gradients of drawn values to those of what trains and, where bits count, of what MLP_p said.
SGI_KERNEL(price_features, kFeatureThreads, FeatureArguments) {
  const FeatureState s = feature_state_of(a);
  for_each_seed(block, a, [&](int seed) {
    const SeedRows slopes = rows_of(a, a.slopes, seed);
    if (s.priced)
      price_values(s, seed, a.price, BitRows(s, rows_of(a, a.bit_rows, seed)), slopes, rows_of(a, a.up_context, seed));
    descend_scales(s, rows_of(a, a.values, seed), slopes);
  });
}

// Gradients of θ, a thread for each: straight through the signs where |θ| <= 1, over all corners that read an entry, in
// the order of seeds. `reads` lists them as places in `entry`, those of entry e from read_start[e] on.
SGI_KERNEL(descend_tables, kFeatureThreads, FeatureArguments) {
  block.each([&](int t) {
    const int at = block.index() * kFeatureThreads + t;
    if (at >= a.entries * a.entry_features) return;
    const int entry = at / a.entry_features, feature = at % a.entry_features;
    int r = 0;
    while (entry >= a.table_start[r + 1]) ++r;
    float sum = a.sign_slopes[r];
    const float *up = a.hash_slopes + int64_t(r * a.entry_features + feature) * a.count;
    for (int i = a.read_start[entry]; i < a.read_start[entry + 1]; ++i)
      sum += a.weight[a.reads[i]] * up[a.reads[i] / (4 * a.resolutions)];
    a.tables[at] = absv(a.theta[at]) > 1.0f ? 0.0f : sum;
  });
}

}  // namespace sgi
