#include "model/model_gaussians.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"
#include "model/constants.hpp"
#include "model/gaussians.hpp"
#include "model/rotated_gaussian.hpp"

namespace sgi {
namespace {

constexpr double kValueUnit = 0x1p-24;  // of decoded attributes

void plain_gaussians(const ModelSpec &spec, const ModelSeeds &seeds, int threads, Isa isa, const SeedGaussians &out) {
  std::vector<int32_t> half_pixels(2 * seeds.count);
  for (int64_t i = 0; i < seeds.count; ++i)
    for (int axis = 0; axis < 2; ++axis)
      half_pixels[2 * i + axis] = 2 * seeds.corner[2 * i + axis] + (1 << seeds.log_size[i]);
  std::vector<double> values(seeds.count * spec.attributes());
  for (size_t i = 0; i < values.size(); ++i) values[i] = double(seeds.decoded[i]) * kValueUnit;
  seed_gaussians({spec.channels}, {half_pixels.data(), seeds.log_size}, seeds.count, values.data(), threads, isa, out);
}

// Two linear layers with what is negative cut off between them; rows of weights by input, so that sums run along them.
class Perceptron {
 public:
  Perceptron(const DecoderWeights &weights, int inputs)
      : hidden_(int(weights.b1.size())), outputs_(int(weights.b2.size())), w1_(turned(weights.w1, hidden_, inputs)),
        b1_(weights.b1), w2_(turned(weights.w2, outputs_, hidden_)), b2_(weights.b2), inputs_(inputs) {}

  // Writes to out [O] what it says of features [D].
  void decode(const float *features, std::vector<float> &hidden, float *out) const {
    hidden.assign(hidden_, 0.0f);
    multiply(w1_, features, inputs_, hidden_, hidden.data());
    for (int h = 0; h < hidden_; ++h) hidden[h] = std::max(hidden[h] + b1_[h], 0.0f);
    std::fill_n(out, outputs_, 0.0f);
    multiply(w2_, hidden.data(), hidden_, outputs_, out);
    for (int o = 0; o < outputs_; ++o) out[o] += b2_[o];
  }

 private:
  static std::vector<float> turned(const std::vector<float> &matrix, int rows, int columns) {
    std::vector<float> out(matrix.size());
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) out[size_t(c) * rows + r] = matrix[size_t(r) * columns + c];
    return out;
  }
  static void multiply(const std::vector<float> &weights, const float *from, int inputs, int outputs, float *sums) {
    for (int i = 0; i < inputs; ++i)
      for (int o = 0; o < outputs; ++o) sums[o] += from[i] * weights[size_t(i) * outputs + o];
  }

  int hidden_, outputs_;
  std::vector<float> w1_, b1_, w2_, b2_;
  int inputs_;
};

// Seeds whose attributes are features, which networks decode, scales and offsets.
class FeatureSeeds {
 public:
  FeatureSeeds(const ModelSpec &spec, const ModelSeeds &seeds, const DecoderWeights &colours,
               const DecoderWeights &shapes, const SeedGaussians &out)
      : spec_(spec), seeds_(seeds), colours_(colours, spec.features), shapes_(shapes, spec.features), out_(out) {}

  void write(int64_t begin, int64_t end) const {
    const int width = spec_.attributes(), k = spec_.per_seed;
    std::vector<float> values(width), shapes(3 * k), hidden;
    for (int64_t seed = begin; seed < end; ++seed) {
      for (int i = 0; i < width; ++i) values[i] = float(double(seeds_.decoded[seed * width + i]) * kValueUnit);
      colours_.decode(values.data(), hidden, out_.colours + seed * k * spec_.channels);
      shapes_.decode(values.data(), hidden, shapes.data());
      write_places(values.data() + spec_.features, shapes, seed);
    }
  }

 private:
  // rest: scales, then offsets.
  void write_places(const float *rest, const std::vector<float> &shapes, int64_t seed) const {
    float scales[4];
    for (int i = 0; i < 4; ++i) scales[i] = std::max(rest[i], 0.0f);
    const float *offsets = rest + 4, cell = std::ldexp(1.0f, seeds_.log_size[seed]);
    for (int k = 0; k < spec_.per_seed; ++k) {
      const int64_t at = seed * spec_.per_seed + k;
      for (int axis = 0; axis < 2; ++axis) {
        const float centre = float(seeds_.corner[2 * seed + axis]) + 0.5f * cell;
        out_.means[2 * at + axis] = centre + cell * offsets[2 * k + axis] * scales[axis];
      }
      const RotatedCovariance<float> covariance(&shapes[3 * k], cell * scales[2], cell * scales[3]);
      float *out = out_.covariances + 3 * at;
      out[0] = covariance.xx() + float(kMinVariance), out[1] = covariance.xy();
      out[2] = covariance.yy() + float(kMinVariance);
    }
  }

  const ModelSpec &spec_;
  const ModelSeeds seeds_;
  const Perceptron colours_, shapes_;
  const SeedGaussians out_;
};

}  // namespace

void model_gaussians(const ModelSpec &spec, const ModelSeeds &seeds, const DecoderWeights &colours,
                     const DecoderWeights &shapes, int threads, Isa isa, const SeedGaussians &out) {
  if (spec.is_plain()) return plain_gaussians(spec, seeds, threads, isa, out);
  constexpr int64_t kRun = 256;
  const FeatureSeeds features(spec, seeds, colours, shapes, out);
  parallel_for((seeds.count + kRun - 1) / kRun, threads,
               [&](int64_t run) { features.write(run * kRun, std::min(seeds.count, (run + 1) * kRun)); });
}

}  // namespace sgi
