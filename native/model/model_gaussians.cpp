#include "model/model_gaussians.hpp"

#include <algorithm>
#include <cmath>

#include "base/thread_pool.hpp"
#include "model/colours.hpp"
#include "model/constants.hpp"
#include "model/gaussians.hpp"
#include "model/rotated_gaussian.hpp"

namespace sgi {
namespace {

constexpr double kUnit = 0x1p-24;  // of decoded attributes

std::vector<float> opponent_of(int channels) {
  const std::vector<double> matrix = colour_matrix(channels);
  return {matrix.begin(), matrix.end()};
}

void plain_gaussians(const ModelSpec &spec, const ModelSeeds &seeds, int threads, Isa isa, const SeedGaussians &out) {
  std::vector<int32_t> half_pixels(2 * seeds.count);
  for (int64_t i = 0; i < seeds.count; ++i)
    for (int axis = 0; axis < 2; ++axis)
      half_pixels[2 * i + axis] = 2 * seeds.corner[2 * i + axis] + (1 << seeds.log_size[i]);
  std::vector<double> values(seeds.count * spec.attributes());
  for (size_t i = 0; i < values.size(); ++i) values[i] = double(seeds.decoded[i]) * kUnit;
  const std::vector<float> opponent = opponent_of(spec.channels);
  seed_gaussians({spec.channels, opponent.data()}, {half_pixels.data(), seeds.log_size}, seeds.count, values.data(),
                 threads, isa, out);
}

// Two linear layers with what is negative cut off between them; rows of weights by input, so that sums run along them.
class Perceptron {
 public:
  Perceptron(const DecoderWeights &weights, int inputs)
      : hidden_(int(weights.b1.size())), outputs_(int(weights.b2.size())), w1_(turned(weights.w1, hidden_, inputs)),
        b1_(weights.b1), w2_(turned(weights.w2, outputs_, hidden_)), b2_(weights.b2), inputs_(inputs) {}

  // Adds to out [O] what it says of features [D].
  void add(const float *features, std::vector<float> &scratch, float *out) const {
    if (!hidden_) return;
    scratch.assign(hidden_ + outputs_, 0.0f);
    float *hidden = scratch.data(), *said = hidden + hidden_;
    multiply(w1_, features, inputs_, hidden_, hidden);
    for (int h = 0; h < hidden_; ++h) hidden[h] = std::max(hidden[h] + b1_[h], 0.0f);
    multiply(w2_, hidden, hidden_, outputs_, said);
    for (int o = 0; o < outputs_; ++o) out[o] += said[o] + b2_[o];
  }

 private:
  static std::vector<float> turned(const std::vector<float> &matrix, int rows, int columns) {
    std::vector<float> out(matrix.size());
    for (int r = 0; r < (out.empty() ? 0 : rows); ++r)
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

// `cell`: pixels; shape [3]; scales [2] in sides of the cell.
void log_covariance(const float *shape, const float *scales, float cell, float *out) {
  const Covariance<float> covariance({shape[0], shape[1], shape[2]}, cell * cell * scales[0] * scales[1]);
  out[0] = covariance.xx(), out[1] = covariance.xy(), out[2] = covariance.yy();
}

void rotated_covariance(const float *shape, const float *scales, float cell, float *out) {
  const RotatedCovariance<float> rotated(shape, cell * scales[0], cell * scales[1]);
  out[0] = rotated.xx() + float(kMinVariance), out[1] = rotated.xy(), out[2] = rotated.yy() + float(kMinVariance);
}

// Seeds whose attributes are features that networks decode, or that have scales, or rotations.
class GeneralSeeds {
 public:
  GeneralSeeds(const ModelSpec &spec, const ModelSeeds &seeds, const DecoderWeights &colours,
               const DecoderWeights &shapes, const SeedGaussians &out)
      : spec_(spec), seeds_(seeds), colours_(colours, spec.features), shapes_(shapes, spec.features),
        opponent_(opponent_of(spec.channels)), out_(out) {
    for (const SeedGroup &group : spec.groups()) {
      if (group.name == GroupName::scales) scales_ = group.start;
      if (group.name == GroupName::offset) offset_ = group.start;
    }
  }

  void write(int64_t begin, int64_t end) const {
    const int width = spec_.attributes(), k = spec_.per_seed, channels = spec_.channels;
    std::vector<float> values(width), colours(k * channels), shapes(3 * k), scratch;
    for (int64_t seed = begin; seed < end; ++seed) {
      for (int i = 0; i < width; ++i) values[i] = float(double(seeds_.decoded[seed * width + i]) * kUnit);
      std::fill(colours.begin(), colours.end(), 0.0f);
      std::fill(shapes.begin(), shapes.end(), 0.0f);
      colours_.add(values.data(), scratch, colours.data());
      shapes_.add(values.data(), scratch, shapes.data());
      if (spec_.skip) {
        for (size_t i = 0; i < colours.size(); ++i) colours[i] += values[i];
        for (size_t i = 0; i < shapes.size(); ++i) shapes[i] += values[colours.size() + i];
      }
      write_colours(colours, seed);
      write_places(values, shapes, seed);
    }
  }

 private:
  void write_colours(const std::vector<float> &colours, int64_t seed) const {
    const int channels = spec_.channels;
    float *out = out_.colours + seed * int64_t(colours.size());
    if (!spec_.skip) {
      std::copy(colours.begin(), colours.end(), out);
      return;
    }
    for (int k = 0; k < spec_.per_seed; ++k)
      for (int c = 0; c < channels; ++c) {
        float sum = 0;
        for (int j = 0; j < channels; ++j) sum += colours[k * channels + j] * opponent_[j * channels + c];
        out[k * channels + c] = sum;
      }
  }

  void write_places(const std::vector<float> &values, const std::vector<float> &shapes, int64_t seed) const {
    float scales[4] = {1, 1, 1, 1};
    if (spec_.seed_scales)
      for (int i = 0; i < 4; ++i) scales[i] = std::max(values[scales_ + i], 0.0f);
    const float cell = std::ldexp(1.0f, seeds_.log_size[seed]);
    for (int k = 0; k < spec_.per_seed; ++k) {
      const int64_t at = seed * spec_.per_seed + k;
      for (int axis = 0; axis < 2; ++axis) {
        const float centre = float(seeds_.corner[2 * seed + axis]) + 0.5f * cell;
        out_.means[2 * at + axis] = centre + cell * values[offset_ + 2 * k + axis] * scales[axis];
      }
      (spec_.shape == ShapeKind::rotation ? rotated_covariance : log_covariance)(&shapes[3 * k], scales + 2, cell,
                                                                                 out_.covariances + 3 * at);
    }
  }

  const ModelSpec &spec_;
  const ModelSeeds seeds_;
  const Perceptron colours_, shapes_;
  const std::vector<float> opponent_;
  const SeedGaussians out_;
  int scales_ = 0, offset_ = 0;
};

}  // namespace

void model_gaussians(const ModelSpec &spec, const ModelSeeds &seeds, const DecoderWeights &colours,
                     const DecoderWeights &shapes, int threads, Isa isa, const SeedGaussians &out) {
  if (spec.is_plain()) return plain_gaussians(spec, seeds, threads, isa, out);
  constexpr int64_t kRun = 256;
  const GeneralSeeds general(spec, seeds, colours, shapes, out);
  parallel_for((seeds.count + kRun - 1) / kRun, threads,
               [&](int64_t run) { general.write(run * kRun, std::min(seeds.count, (run + 1) * kRun)); });
}

}  // namespace sgi
