// The step of seeds that hold features, forward and backward.
#include "base/lanes.hpp"
#include "fit/feature_kernel.hpp"
#include "fit/feature_prediction.hpp"
#include "fit/noise.hpp"
#include "fit/seed_matrix.hpp"
#include "model/rotated_gaussian.hpp"

namespace sgi {
namespace {

// Rows of a batch of seeds: those that outlive the way forward, and in the memory of a run those that do not.
struct Memory {
  float *drawn, *hidden[2], *shapes;    // attributes as drawn; of MLP_c and MLP_Sigma, and what the latter says
  float *hash, *context_hidden, *said;  // of MLP_p
  float *values, *slopes, *colours;     // attributes: exact, gradients of either; what MLP_c says
  float *up_colours, *up_shapes, *hidden_slopes;  // gradients
  float *up_said, *context_slopes, *hash_slopes;

  Memory(const FeatureState &s, int64_t first, float *scratch) {
    float *at = s.kept + first / kBatchSeeds * s.kept_rows() * kPitch;
    const auto take = [&](int rows) {
      float *from = at;
      at += int64_t(rows) * kPitch;
      return from;
    };
    drawn = take(s.attributes()), hidden[0] = take(s.hidden), hidden[1] = take(s.hidden), shapes = take(s.shapes());
    hash = take(s.hash_features), context_hidden = take(s.context_hidden), said = take(s.context_outputs());
    at = scratch;
    values = take(s.attributes()), slopes = take(s.attributes()), colours = take(s.colours());
    up_colours = take(s.colours()), up_shapes = take(s.shapes()), hidden_slopes = take(s.hidden);
    up_said = take(s.context_outputs()), context_slopes = take(s.context_hidden), hash_slopes = take(s.hash_features);
  }
};

struct Decoders {
  Perceptron colours, shapes;

  explicit Decoders(const FeatureState &s)
      : colours(one(s, s.decoders, s.colours())), shapes(one(s, s.decoders + s.decoder_size(s.colours()), s.shapes())) {
  }

  static Perceptron one(const FeatureState &s, const float *at, int outputs) {
    const float *b1 = at + s.hidden * s.features, *w2 = b1 + s.hidden, *b2 = w2 + outputs * s.hidden;
    return {at, b1, w2, b2, s.features, s.features, s.hidden, outputs};
  }
};

inline PerceptronSums decoder_sums(const FeatureState &s, float *at, int outputs) {
  float *b1 = at + s.hidden * s.features, *w2 = b1 + s.hidden;
  return {at, b1, w2, w2 + outputs * s.hidden};
}

inline Perceptron context_of(const FeatureState &s) {
  const float *w2 = s.rest + s.context_hidden, *b2 = w2 + s.context_outputs() * s.context_hidden;
  return {s.first + kLevelInputs, s.bias, w2, b2, s.context_inputs(), s.hash_features, s.context_hidden,
          s.context_outputs()};
}

inline PerceptronSums context_sums(const FeatureState &s, float *rest) {
  float *w2 = rest + s.context_hidden, *b2 = w2 + s.context_outputs() * s.context_hidden;
  return {b2 + s.context_outputs() + kLevelInputs, rest, w2, b2};
}

inline void read_columns(const float *values, int width, int64_t first, int64_t count, float *rows) {
  for (int i = 0; i < kBatchSeeds; ++i) {
    const float *from = values + (first + i < count ? first + i : count - 1) * width;
    for (int j = 0; j < width; ++j) rows[j * kPitch + i] = from[j];
  }
}

inline void write_columns(const float *rows, int width, int64_t first, int64_t count, float *values) {
  for (int i = 0; i < kBatchSeeds && first + i < count; ++i)
    for (int j = 0; j < width; ++j) values[(first + i) * width + j] = rows[j * kPitch + i];
}

// Values as they are coded: s_o and s_a themselves, of which the logarithms train.
inline void read_values(const FeatureState &s, int64_t first, float *values) {
  read_columns(s.feature, s.features, first, s.count, values);
  read_columns(s.scales, kSeedScales, first, s.count, values + s.first_scale() * kPitch);
  read_columns(s.offset, 2 * s.per_seed, first, s.count, values + s.first_offset() * kPitch);
  for (int j = s.first_scale(); j < s.first_offset(); ++j)
    for (int v = 0; v < kVectors; ++v) {
      float *at = values + j * kPitch + v * LANES;
      store(at, exp2v(load(at) * kLog2e));
    }
}

// What H says of a batch's seeds.
inline void read_hash(const FeatureState &s, int64_t first, float *rows) {
  for (int i = 0; i < kBatchSeeds; ++i) {
    const int64_t seed = first + i < s.count ? first + i : s.count - 1;
    for (int r = 0; r < s.resolutions; ++r) {
      const int32_t *entry = s.entry + (seed * s.resolutions + r) * 4;
      const float *weight = s.weight + (seed * s.resolutions + r) * 4;
      for (int f = 0; f < s.entry_features; ++f) {
        float sum = 0;
        for (int c = 0; c < 4; ++c) sum += weight[c] * s.signs[int64_t(entry[c]) * s.entry_features + f];
        rows[(r * s.entry_features + f) * kPitch + i] = sum;
      }
    }
  }
}

inline void predict(const FeatureState &s, int64_t first, const Memory &m) {
  read_hash(s, first, m.hash);
  evaluate(context_of(s), m.hash, m.context_hidden, m.said);
}

// What MLP_p says of an attribute of LANES seeds.
inline FeatureUnit unit_of(const FeatureState &s, const Memory &m, int attribute, int v) {
  const int at = v * LANES;
  const float *mean = m.said + attribute * kPitch, *scale = mean + s.attributes() * kPitch;
  const float *refine = m.said + (2 * s.attributes() + s.group_of(attribute)) * kPitch;
  return FeatureUnit(s.steps[attribute], load(mean + at), load(scale + at), load(refine + at));
}

// Attributes as drawn, rows of `drawn`, and their bits.
inline void draw(const FeatureState &s, int64_t first, const Memory &m, vf *bits) {
  for (int v = 0; v < kVectors; ++v) bits[v] = vf{};
  if (s.priced) predict(s, first, m);
  for (int j = 0; j < s.attributes(); ++j)
    for (int v = 0; v < kVectors; ++v) {
      const int at = j * kPitch + v * LANES;
      vf value = load(m.values + at);
      if (s.rounding == Rounding::kNoise) {
        const vf spread = noise(s.key, s.mirror, j, first + v * LANES);
        if (s.priced) {
          const FeatureUnit unit = unit_of(s, m, j, v);
          value += unit.step * spread;
          bits[v] += gaussian_bits(value - unit.mean, unit.step, unit.scale).bits;
        } else {
          value += s.steps[j] * spread;
        }
      }
      store(m.drawn + at, value);
    }
}

inline void decode(const FeatureState &s, const Memory &m) {
  const Decoders decoders(s);
  evaluate(decoders.colours, m.drawn, m.hidden[0], m.colours);
  evaluate(decoders.shapes, m.drawn, m.hidden[1], m.shapes);
}

// A batch's LANES seeds on their way to Gaussians.
struct Place {
  Block block;
  const float *drawn, *shapes;  // rows, at their first seed
  vf scales[kSeedScales];
  float scale;

  Place(const FeatureState &s, const Memory &m, int64_t first, int v)
      : block(first + v * LANES, s.count), drawn(m.drawn + v * LANES), shapes(m.shapes + v * LANES), scale(s.scale) {
    for (int i = 0; i < kSeedScales; ++i) scales[i] = maxv(load(drawn + (s.first_scale() + i) * kPitch), vf{});
  }
  RotatedCovariance<vf> covariance(int k) const {
    vf shape[3];
    for (int i = 0; i < 3; ++i) shape[i] = load(shapes + (3 * k + i) * kPitch);
    return RotatedCovariance<vf>(shape, scale * scales[2], scale * scales[3]);
  }
};

inline void write_gaussians(const FeatureState &s, int64_t first, const Memory &m, const SeedGaussians &out) {
  for (int v = 0; v < kVectors && first + v * LANES < s.count; ++v) {
    const Place place(s, m, first, v);
    for (int i = 0; i < s.colours(); ++i)
      place.block.scatter(load(m.colours + i * kPitch + v * LANES), out.colours, s.colours(), i);
    for (int k = 0; k < s.per_seed; ++k) {
      const RotatedCovariance<vf> covariance = place.covariance(k);
      const int width = 3 * s.per_seed;
      place.block.scatter(covariance.xx() + float(kMinVariance), out.covariances, width, 3 * k);
      place.block.scatter(covariance.xy(), out.covariances, width, 3 * k + 1);
      place.block.scatter(covariance.yy() + float(kMinVariance), out.covariances, width, 3 * k + 2);
      for (int axis = 0; axis < 2; ++axis) {
        const vf offset = load(place.drawn + (s.first_offset() + 2 * k + axis) * kPitch) * place.scales[axis];
        const vf centre = place.block.gather(s.half_pixels, 2, axis) * 0.5f;
        place.block.scatter(s.scale * (centre + offset), out.means, 2 * s.per_seed, 2 * k + axis);
      }
    }
  }
}

// From gradients of Gaussians to those of the decoders' outputs, of scales and of offsets; none of what is no seed.
inline void read_slopes(const FeatureState &s, int64_t first, const FeatureGradients &g, const Memory &m) {
  for (int v = 0; v < kVectors; ++v) {
    const Place place(s, m, first, v);
    const Block &block = place.block;
    const int at = v * LANES;
    for (int i = 0; i < s.colours(); ++i)
      store(m.up_colours + i * kPitch + at, block.gather(g.colours, s.colours(), i) * block.live);
    vf scales[kSeedScales] = {};
    for (int k = 0; k < s.per_seed; ++k) {
      vf shape[3], reaches[2];
      const auto up = [&](int i) { return block.gather(g.covariances, 3 * s.per_seed, 3 * k + i) * block.live; };
      place.covariance(k).descend(up(0), up(1), up(2), shape, reaches);
      for (int i = 0; i < 3; ++i) store(m.up_shapes + (3 * k + i) * kPitch + at, shape[i]);
      for (int axis = 0; axis < 2; ++axis) {
        const int row = (s.first_offset() + 2 * k + axis) * kPitch;
        const vf mean = s.scale * block.live * block.gather(g.means, 2 * s.per_seed, 2 * k + axis);
        store(m.slopes + row + at, mean * place.scales[axis]);
        scales[axis] += mean * load(place.drawn + row);
        scales[2 + axis] += s.scale * reaches[axis];
      }
    }
    for (int i = 0; i < kSeedScales; ++i) {
      const int row = (s.first_scale() + i) * kPitch + at;
      store(m.slopes + row, select(load(m.drawn + row) > 0.0f, scales[i], vf{}));
    }
  }
}

// From gradients of the drawn values to those of the values, with those of their bits, and of what MLP_p said.
inline void price(const FeatureState &s, int64_t first, float one, const Memory &m) {
  const int attributes = s.attributes();
  fill(nullptr, s.context_outputs(), m.up_said);
  for (int v = 0; v < kVectors; ++v) {
    const Block block(first + v * LANES, s.count);
    const vf drawn = noise(s.key, s.mirror, attributes, block.first) + 0.5f;
    const vf bit = select(drawn < s.share, block.live * one, vf{});
    vf refine[kRefinements] = {};
    for (int j = 0; j < attributes; ++j) {
      const int at = j * kPitch + v * LANES;
      const FeatureUnit unit = unit_of(s, m, j, v);
      const Bits<vf> b = gaussian_bits(load(m.drawn + at) - unit.mean, unit.step, unit.scale);
      const vf slope = bit * b.deviation, value = load(m.slopes + at) + slope;
      store(m.slopes + at, value);
      const vf spread = noise(s.key, s.mirror, j, block.first);
      const FeatureUnit::Slopes up = unit.descend(-slope, bit * b.scale, bit * b.step + spread * value);
      store(m.up_said + at, up.mean);
      store(m.up_said + at + attributes * kPitch, up.scale);
      refine[s.group_of(j)] += up.refine;
    }
    for (int i = 0; i < kRefinements; ++i) store(m.up_said + (2 * attributes + i) * kPitch + v * LANES, refine[i]);
  }
}

// Those of the logarithms of s_o and s_a from those of themselves.
inline void descend_scales(const FeatureState &s, const Memory &m) {
  for (int j = s.first_scale(); j < s.first_offset(); ++j)
    for (int v = 0; v < kVectors; ++v) {
      const int at = j * kPitch + v * LANES;
      store(m.slopes + at, load(m.slopes + at) * load(m.values + at));
    }
}

double forward(const FeatureState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *memory) {
  double total = 0;
  for (int64_t first = begin; first < end; first += kBatchSeeds) {
    const Memory m(s, first, memory);
    vf bits[kVectors];
    read_values(s, first, m.values);
    draw(s, first, m, bits);
    for (int64_t i = 0; i < kBatchSeeds && first + i < s.count; ++i)
      total += s.bits[first + i] = lane(bits[i / LANES], int(i % LANES));
    decode(s, m);
    write_gaussians(s, first, m, out);
  }
  return total;
}

void backward(const FeatureState &s, int64_t begin, int64_t end, const FeatureGradients &g, float *sums,
              float *memory) {
  float *shape_sums = sums + s.decoder_size(s.colours());
  for (int64_t first = begin; first < end; first += kBatchSeeds) {
    const Memory m(s, first, memory);
    read_values(s, first, m.values);
    read_slopes(s, first, g, m);
    fill(nullptr, s.features, m.slopes);
    const Decoders decoders(s);
    descend(decoders.colours, m.drawn, m.hidden[0], m.up_colours, m.hidden_slopes, decoder_sums(s, sums, s.colours()),
            m.slopes);
    descend(decoders.shapes, m.drawn, m.hidden[1], m.up_shapes, m.hidden_slopes,
            decoder_sums(s, shape_sums, s.shapes()), m.slopes);
    if (s.priced) {
      price(s, first, g.price, m);
      fill(nullptr, s.hash_features, m.hash_slopes);
      descend(context_of(s), m.hash, m.context_hidden, m.up_said, m.context_slopes,
              context_sums(s, sums + s.decoders_size()), m.hash_slopes);
      write_columns(m.hash_slopes, s.hash_features, first, s.count, s.hash_slopes);
    }
    descend_scales(s, m);
    write_columns(m.slopes, s.features, first, s.count, g.feature);
    write_columns(m.slopes + s.first_scale() * kPitch, kSeedScales, first, s.count, g.scales);
    write_columns(m.slopes + s.first_offset() * kPitch, 2 * s.per_seed, first, s.count, g.offset);
  }
}

}  // namespace

const FeatureKernel FeatureKernel::SGI_ISA{sgi::forward, sgi::backward};

}  // namespace sgi
