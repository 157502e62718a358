// The step of seeds that hold features, forward and backward.
#include "fit/feature_seeds.hpp"
#include "fit/seed_matrix.hpp"

namespace sgi {
namespace {

// Rows of a batch of seeds: those that outlive the way forward, and in the memory of a run those that do not.
struct Memory {
  float *drawn, *hidden[2], *shapes;     // attributes as drawn; of MLP_c and MLP_Sigma, and what the latter says
  float *hash, *context_hidden, *bits;   // inputs and hidden values of MLP_p, and what bits leave
  float *values, *slopes;                // attributes: exact, gradients of either
  float *means, *covariances, *colours;  // of Gaussians, or their gradients
  float *said;                           // what MLP_p says
  float *up_shapes, *hidden_slopes;      // gradients
  float *up_said, *context_slopes, *hash_slopes;
  float *turned;  // what a layer sees, seed by seed

  Memory(const FeatureState &s, int64_t first, float *scratch) {
    float *at = s.kept + first / kBatchSeeds * s.kept_rows() * kPitch;
    const auto take = [&](int rows) {
      float *from = at;
      at += int64_t(rows) * kPitch;
      return from;
    };
    drawn = take(s.attributes()), hidden[0] = take(s.hidden), hidden[1] = take(s.hidden), shapes = take(s.shapes());
    hash = take(s.hash_features), context_hidden = take(s.context_hidden), bits = take(s.bit_rows());
    at = scratch;
    values = take(s.attributes()), slopes = take(s.attributes()), means = take(2 * s.per_seed);
    covariances = take(3 * s.per_seed), colours = take(s.colours()), up_shapes = take(s.shapes()),
    hidden_slopes = take(s.hidden);
    said = take(s.context_outputs()), up_said = take(s.context_outputs()), context_slopes = take(s.context_hidden),
    hash_slopes = take(s.hash_features);
    turned = take(s.turned_rows());
  }
};

// Where W1, b1, W2, b2 of MLP_c or MLP_Sigma lie, which begin at `at`: weights or sums.
template <class T>
PerceptronArrays<T> decoder_arrays(const FeatureModel &m, T *at, int outputs) {
  T *b1 = at + m.hidden * m.features, *w2 = b1 + m.hidden;
  return {at, b1, w2, w2 + outputs * m.hidden};
}

// The same of MLP_p without the inputs that all seeds share: W1 in `first`, the others in `rest`.
template <class T>
PerceptronArrays<T> context_arrays(const FeatureModel &m, T *first, T *rest) {
  T *w2 = rest + m.context_hidden;
  return {first + kLevelInputs, rest, w2, w2 + m.context_outputs() * m.context_hidden};
}

struct Decoders {
  Perceptron colours, shapes;

  explicit Decoders(const FeatureState &s)
      : colours(one(s, s.decoders, s.colours())), shapes(one(s, s.decoders + s.decoder_size(s.colours()), s.shapes())) {
  }

  static Perceptron one(const FeatureState &s, const float *at, int outputs) {
    return {decoder_arrays(s, at, outputs), s.features, s.features, s.hidden, outputs};
  }
};

inline Perceptron context_of(const FeatureState &s) {
  PerceptronArrays<const float> arrays = context_arrays(s, s.first, s.rest);
  arrays.b1 = s.bias;
  return {arrays, s.context_inputs(), s.hash_features, s.context_hidden, s.context_outputs()};
}

// Calls visit(seed, column) for squares of LANES seeds and columns that cover `width` columns; the last ones overlap.
template <class Visit>
inline void for_each_square(int width, const Visit &visit) {
  for (int i = 0; i < kBatchSeeds; i += LANES)
    for (int j = 0; j < width; j += LANES) visit(i, j + LANES <= width ? j : width - LANES);
}

// A batch's values [N, width] as rows. What is behind the last seed stands for that one.
inline void read_columns(const float *values, int width, int64_t first, int64_t count, float *rows) {
  const auto of = [&](int i) { return values + (first + i < count ? first + i : count - 1) * width; };
  if (width < LANES) {
    for (int i = 0; i < kBatchSeeds; ++i)
      for (int j = 0; j < width; ++j) rows[j * kPitch + i] = of(i)[j];
    return;
  }
  for_each_square(width, [&](int seed, int column) {
    vf square[LANES];
    for (int i = 0; i < LANES; ++i) square[i] = load(of(seed + i) + column);
    turn(square, std::make_index_sequence<LANES>{});
    for (int i = 0; i < LANES; ++i) store(rows + (column + i) * kPitch + seed, square[i]);
  });
}

// The same of gradients, of which what is behind the last seed has none.
inline void read_slopes(const float *slopes, int width, int64_t first, int64_t count, float *rows) {
  read_columns(slopes, width, first, count, rows);
  for (int j = 0; j < width; ++j)
    for (int64_t i = count - first; i < kBatchSeeds; ++i) rows[j * kPitch + i] = 0;
}

inline void write_columns(const float *rows, int width, int64_t first, int64_t count, float *values) {
  if (width < LANES) {
    for (int i = 0; i < kBatchSeeds && first + i < count; ++i)
      for (int j = 0; j < width; ++j) values[(first + i) * width + j] = rows[j * kPitch + i];
    return;
  }
  for_each_square(width, [&](int seed, int column) {
    vf square[LANES];
    for (int i = 0; i < LANES; ++i) square[i] = load(rows + (column + i) * kPitch + seed);
    turn(square, std::make_index_sequence<LANES>{});
    for (int i = 0; i < LANES && first + seed + i < count; ++i)
      store(values + (first + seed + i) * width + column, square[i]);
  });
}

// Calls visit(v, at) for every vector of a batch; at(rows) are rows at the columns of its seeds.
template <class Visit>
inline void for_each_vector(const Visit &visit) {
  for (int v = 0; v < kVectors; ++v) visit(v, [v](float *rows) { return SeedRows{rows + v * LANES, kPitch}; });
}

inline void read_scales(const FeatureState &s, int64_t first, float *values) {
  read_columns(s.scales, kSeedScales, first, s.count, values + s.first_scale() * kPitch);
  for_each_vector([&](int, const auto &at) {
    const SeedRows rows = at(values);
    for (int j = s.first_scale(); j < s.first_offset(); ++j) rows.set(j, coded_value(s, j, rows.get(j)));
  });
}

inline void read_values(const FeatureState &s, int64_t first, float *values) {
  read_columns(s.feature, s.features, first, s.count, values);
  read_scales(s, first, values);
  read_columns(s.offset, 2 * s.per_seed, first, s.count, values + s.first_offset() * kPitch);
}

// What H says of a batch's seeds.
inline void read_hash(const FeatureState &s, int64_t first, float *rows) {
  for (int i = 0; i < kBatchSeeds; ++i) {
    const int64_t seed = first + i < s.count ? first + i : s.count - 1;
    for (int r = 0; r < s.resolutions; ++r) {
      float *from = rows + r * s.entry_features * kPitch + i;
      s.entry_features == 4 ? see_signs<4>(s, seed, r, from, kPitch) : see_signs<0>(s, seed, r, from, kPitch);
    }
  }
}

inline void predict(const FeatureState &s, int64_t first, const Memory &m) {
  read_hash(s, first, m.hash);
  evaluate(context_of(s), m.hash, m.context_hidden, m.said);
}

// Attributes as drawn, rows of `drawn`, and their bits.
inline void draw(const FeatureState &s, int64_t first, const Memory &m, vf *bits) {
  if (s.priced) predict(s, first, m);
  for_each_vector([&](int v, const auto &at) {
    bits[v] = draw_values(s, first + v * LANES, at(m.values), at(m.said), at(m.drawn), BitRows(s, at(m.bits)));
  });
}

inline void decode(const FeatureState &s, const Memory &m) {
  const Decoders decoders(s);
  evaluate(decoders.colours, m.drawn, m.hidden[0], m.colours);
  evaluate(decoders.shapes, m.drawn, m.hidden[1], m.shapes);
}

template <class Rows>
inline SeedPlace place_of(const FeatureState &s, const Memory &m, int64_t first, int v, const Rows &at) {
  return SeedPlace(s, first + v * LANES, at(m.drawn), at(m.shapes));
}

inline void write_batch(const FeatureState &s, int64_t first, const Memory &m, const SeedGaussians &out) {
  for_each_vector(
      [&](int v, const auto &at) { place_gaussians(s, place_of(s, m, first, v, at), at(m.means), at(m.covariances)); });
  write_columns(m.means, 2 * s.per_seed, first, s.count, out.means);
  write_columns(m.covariances, 3 * s.per_seed, first, s.count, out.covariances);
  write_columns(m.colours, s.colours(), first, s.count, out.colours);
}

inline void read_batch(const FeatureState &s, int64_t first, const FeatureGradients &g, const Memory &m) {
  read_slopes(g.means, 2 * s.per_seed, first, s.count, m.means);
  read_slopes(g.covariances, 3 * s.per_seed, first, s.count, m.covariances);
  read_slopes(g.colours, s.colours(), first, s.count, m.colours);
  for_each_vector([&](int v, const auto &at) {
    descend_gaussians(s, place_of(s, m, first, v, at), at(m.means), at(m.covariances), at(m.up_shapes), at(m.slopes));
  });
}

inline void price(const FeatureState &s, int64_t first, float one, const Memory &m) {
  for_each_vector([&](int v, const auto &at) {
    price_values(s, first + v * LANES, one, BitRows(s, at(m.bits)), at(m.slopes), at(m.up_said));
  });
}

double forward(const FeatureState &s, int64_t begin, int64_t end, const SeedGaussians &out, float *memory) {
  double total = 0;
  for (int64_t first = begin; first < end; first += kBatchSeeds) {
    const Memory m(s, first, memory);
    vf bits[kVectors];
    read_values(s, first, m.values);
    draw(s, first, m, bits);
    for (int64_t i = 0; i < kBatchSeeds && first + i < s.count; ++i) total += lane(bits[i / LANES], int(i % LANES));
    decode(s, m);
    write_batch(s, first, m, out);
  }
  return total;
}

void backward(const FeatureState &s, int64_t begin, int64_t end, const FeatureGradients &g, float *sums,
              float *memory) {
  float *shape_sums = sums + s.decoder_size(s.colours()), *rest_sums = sums + s.decoders_size();
  for (int64_t first = begin; first < end; first += kBatchSeeds) {
    const Memory m(s, first, memory);
    read_scales(s, first, m.values);
    read_batch(s, first, g, m);
    clear(s.features, m.slopes);
    const Decoders decoders(s);
    descend(decoders.colours, m.drawn, m.hidden[0], m.colours, m.hidden_slopes, m.turned,
            decoder_arrays(s, sums, s.colours()), m.slopes);
    descend(decoders.shapes, m.drawn, m.hidden[1], m.up_shapes, m.hidden_slopes, m.turned,
            decoder_arrays(s, shape_sums, s.shapes()), m.slopes);
    if (s.priced) {
      price(s, first, g.price, m);
      clear(s.hash_features, m.hash_slopes);
      descend(context_of(s), m.hash, m.context_hidden, m.up_said, m.context_slopes, m.turned,
              context_arrays(s, rest_sums + s.rest_size(), rest_sums), m.hash_slopes);
      write_columns(m.hash_slopes, s.hash_features, first, s.count, s.hash_slopes);
    }
    for_each_vector([&](int, const auto &at) { descend_scales(s, at(m.values), at(m.slopes)); });
    write_columns(m.slopes, s.features, first, s.count, g.feature);
    write_columns(m.slopes + s.first_scale() * kPitch, kSeedScales, first, s.count, g.scales);
    write_columns(m.slopes + s.first_offset() * kPitch, 2 * s.per_seed, first, s.count, g.offset);
  }
}

int64_t take_signs(const float *theta, int64_t n, int8_t *signs) {
  for (int64_t i = 0; i < n; ++i) signs[i] = int8_t(theta[i] >= 0 ? 1 : -1);
  int64_t sum = 0;
  for (int64_t i = 0; i < n; ++i) sum += signs[i];
  return (n + sum) / 2;
}

// WIDTH: entry_features, 0 for any.
template <int WIDTH>
inline void add_seen(const FeatureState &s, int resolution, float *tables) {
  const int width = WIDTH ? WIDTH : s.entry_features;
  for (int64_t i = 0; i < s.count; ++i) {
    const int32_t *entry = s.entry + (i * s.resolutions + resolution) * 4;
    const float *weight = s.weight + (i * s.resolutions + resolution) * 4;
    const float *up = s.hash_slopes + i * s.hash_features + resolution * width;
    for (int c = 0; c < 4; ++c)
      for (int f = 0; f < width; ++f) tables[int64_t(entry[c]) * width + f] += weight[c] * up[f];
  }
}

void descend_table(const FeatureState &s, int resolution, int64_t begin, int64_t end, float slope, float *tables) {
  for (int64_t i = begin; i < end; ++i) tables[i] = slope;
  s.entry_features == 4 ? add_seen<4>(s, resolution, tables) : add_seen<0>(s, resolution, tables);
  for (int64_t i = begin; i < end; ++i) tables[i] = s.theta[i] >= -1 && s.theta[i] <= 1 ? tables[i] : 0.0f;
}

}  // namespace

const FeatureKernel FeatureKernel::SGI_ISA{sgi::forward, sgi::backward, sgi::take_signs, sgi::descend_table};

}  // namespace sgi
