#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "fit/adam.hpp"
#include "fit/feature_fit.hpp"
#include "fit/seed_fit.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

using In1 = Array<const float, 1>;
using In2 = Array<const float, 2>;
using Out1 = Array<float, 1>;
using Out2 = Array<float, 2>;

template <class A>
void require_rows(const A &array, int64_t rows, int64_t columns, const char *what) {
  require(has_shape(array, size_t(rows), size_t(columns)), what);
}

void set_layout(sgi::SeedFit &self, Array<const int32_t, 2> half_pixels, Array<const int8_t, 1> log_size,
                Array<const int32_t, 2> neighbour, int colour_step) {
  const int64_t n = int64_t(log_size.shape(0)), k = int64_t(neighbour.shape(1));
  require_rows(half_pixels, n, 2, "half_pixels must be [N, 2]");
  require_rows(neighbour, n, k, "neighbour must be [N, k]");
  require(k <= sgi::kMaxNeighbours, "there are more neighbours than weights for them");
  sgi::require_cells(log_size);
  for (int64_t i = 0; i < n * k; ++i) require(neighbour.data()[i] < n, "a neighbour is no seed");
  self.set_layout({half_pixels.data(), log_size.data()}, n, neighbour.data(), int(k), colour_step);
}

double forward(sgi::SeedFit &self, In2 colour, In2 shape, In2 offset, In1 steps, int rounding, uint32_t key,
               bool negative, bool predicts, Out2 means, Out2 covariances, Out2 colours) {
  const sgi::SeedState &s = self.state();
  require_rows(colour, s.count, s.group_size(0), "colour must be [N, C]");
  require_rows(shape, s.count, s.group_size(1), "shape must be [N, 3]");
  require_rows(offset, s.count, s.group_size(2), "offset must be [N, 2]");
  require(int64_t(steps.shape(0)) == sgi::kSteps, "steps holds base steps and gamma");
  require(rounding >= 0 && rounding <= 2, "rounding is 0, 1 or 2");
  require_rows(means, s.count, 2, "means must be [N, 2]");
  require_rows(covariances, s.count, 3, "covariances must be [N, 3]");
  require_rows(colours, s.count, s.channels, "colours must be [N, C]");
  const sgi::SeedGaussians out{means.data(), covariances.data(), colours.data()};
  nb::gil_scoped_release release;
  return self.forward({colour.data(), shape.data(), offset.data()}, steps.data(), sgi::Rounding(rounding),
                      {key, negative}, predicts, out);
}

void backward(sgi::SeedFit &self, In2 means, In2 covariances, In2 colours, float lmbda, Out2 colour, Out2 shape,
              Out2 offset, Out1 steps) {
  const sgi::SeedState &s = self.state();
  require_rows(means, s.count, 2, "gradients of means must be [N, 2]");
  require_rows(covariances, s.count, 3, "gradients of covariances must be [N, 3]");
  require_rows(colours, s.count, s.channels, "gradients of colours must be [N, C]");
  require_rows(colour, s.count, s.group_size(0), "colour must be [N, C]");
  require_rows(shape, s.count, s.group_size(1), "shape must be [N, 3]");
  require_rows(offset, s.count, s.group_size(2), "offset must be [N, 2]");
  require(int64_t(steps.shape(0)) == sgi::kSteps, "steps has another length");
  const sgi::SeedGradients g{
      means.data(), covariances.data(), colours.data(), lmbda, {colour.data(), shape.data(), offset.data()}};
  nb::gil_scoped_release release;
  self.backward(g, steps.data());
}

void set_pixels(sgi::FeatureFit &self, Array<const int32_t, 2> half_pixels, int colour_step, int64_t width,
                int64_t height) {
  const int64_t n = int64_t(half_pixels.shape(0));
  require_rows(half_pixels, n, 2, "half_pixels must be [N, 2]");
  require(width > 0 && height > 0, "a picture has pixels");
  for (int64_t i = 0; i < n; ++i)
    for (int axis = 0; axis < 2; ++axis) {
      const int64_t at = half_pixels.data()[2 * i + axis];
      require(at >= 0 && at <= 2 * (axis ? height : width), "a seed lies beyond the picture");
    }
  self.set_layout(half_pixels.data(), n, colour_step, width, height);
}

double draw_features(sgi::FeatureFit &self, In2 feature, In2 scales, In2 offset, In1 decoders, In1 first, In1 rest,
                     In1 tables, In1 steps, int rounding, bool priced, uint32_t key, bool negative, float scale,
                     float share, Out2 means, Out2 covariances, Out2 colours) {
  const sgi::FeatureState &s = self.state();
  const int64_t gaussians = s.count * s.per_seed;
  require_rows(feature, s.count, s.features, "feature must be [N, D]");
  require_rows(scales, s.count, sgi::kSeedScales, "scales must be [N, 4]");
  require_rows(offset, s.count, 2 * s.per_seed, "offset must be [N, 2 K]");
  require(int64_t(decoders.shape(0)) == s.decoders_size(), "decoders holds the weights of MLP_c and MLP_Sigma");
  require(int64_t(first.shape(0)) == s.first_size(), "first holds W1");
  require(int64_t(rest.shape(0)) == s.rest_size(), "rest holds b1, W2 and b2");
  require(int64_t(tables.shape(0)) == self.signs(), "tables holds what the hash grid's signs are of");
  require(int64_t(steps.shape(0)) == s.attributes(), "steps holds the base step of each attribute");
  require(rounding == 0 || rounding == 1, "rounding is 0 or 1");
  require_rows(means, gaussians, 2, "means must be [N K, 2]");
  require_rows(covariances, gaussians, 3, "covariances must be [N K, 3]");
  require_rows(colours, gaussians, s.channels, "colours must be [N K, C]");
  const sgi::FeatureDrawing drawing{sgi::Rounding(rounding), priced, {key, negative}, scale, share};
  const sgi::SeedGaussians out{means.data(), covariances.data(), colours.data()};
  nb::gil_scoped_release release;
  return self.forward({feature.data(), scales.data(), offset.data()},
                      {decoders.data(), first.data(), rest.data(), tables.data(), steps.data()}, drawing, out);
}

void descend_features(sgi::FeatureFit &self, In2 means, In2 covariances, In2 colours, float price, float lmbda,
                      Out2 feature, Out2 scales, Out2 offset, Out1 sums, Out1 tables) {
  const sgi::FeatureState &s = self.state();
  const int64_t gaussians = s.count * s.per_seed;
  require_rows(means, gaussians, 2, "gradients of means must be [N K, 2]");
  require_rows(covariances, gaussians, 3, "gradients of covariances must be [N K, 3]");
  require_rows(colours, gaussians, s.channels, "gradients of colours must be [N K, C]");
  require_rows(feature, s.count, s.features, "feature must be [N, D]");
  require_rows(scales, s.count, sgi::kSeedScales, "scales must be [N, 4]");
  require_rows(offset, s.count, 2 * s.per_seed, "offset must be [N, 2 K]");
  require(int64_t(sums.shape(0)) == s.sums(s.priced), "sums has another length");
  require(int64_t(tables.shape(0)) == self.signs(), "tables has another length");
  const sgi::FeatureGradients g{means.data(),   covariances.data(), colours.data(), price,
                                feature.data(), scales.data(),      offset.data()};
  nb::gil_scoped_release release;
  self.backward(g, lmbda, sums.data(), tables.data());
}

void adam_step(Out1 value, In1 gradient, Out1 mean, Out1 square, double beta1, double beta2, double rate,
               double root_correction, double epsilon, int threads, const std::string &isa) {
  const size_t n = value.shape(0);
  require(gradient.shape(0) == n && mean.shape(0) == n && square.shape(0) == n, "all arrays must be [n]");
  const sgi::AdamStep step{beta1, beta2, rate, root_correction, epsilon};
  const sgi::Isa chosen = sgi::choose_isa(isa);
  nb::gil_scoped_release release;
  sgi::adam_step(chosen, threads, step, gradient.data(), int64_t(n), value.data(), mean.data(), square.data());
}

}  // namespace

void bind_fit(nb::module_ &m) {
  m.def("adam_step", &adam_step, "value"_a, "gradient"_a, "mean"_a, "square"_a, "beta1"_a, "beta2"_a, "rate"_a,
        "root_correction"_a, "epsilon"_a, "threads"_a, "isa"_a);
  m.def("sign_slope", &sgi::sign_slope, "positive"_a, "count"_a, "lmbda"_a);
  nb::class_<sgi::SeedFit>(m, "SeedFit")
      .def(
          "__init__",
          [](sgi::SeedFit *self, const std::string &isa, int threads, int channels, int hidden, In1 first, In1 rest) {
            require(channels >= 1 && hidden >= 1, "a model has channels and hidden units");
            sgi::SeedState s{};
            s.hidden = hidden;
            size_t firsts = 0, rests = 0;
            for (int g = 0; g < sgi::kGroups; ++g) firsts += s.first_size(g), rests += s.rest_size(g);
            require(first.shape(0) == firsts, "first holds W1 of all groups");
            require(rest.shape(0) == rests, "rest holds b1, W2 and b2 of all groups");
            new (self) sgi::SeedFit(sgi::choose_isa(isa), threads, channels, hidden, first.data(), rest.data());
          },
          "isa"_a, "threads"_a, "channels"_a, "hidden"_a, "first"_a, "rest"_a)
      .def("set_layout", &set_layout, "half_pixels"_a, "log_size"_a, "neighbour"_a, "colour_step"_a)
      .def("forward", &forward, "colour"_a, "shape"_a, "offset"_a, "steps"_a, "rounding"_a, "key"_a, "negative"_a,
           "predicts"_a, "means"_a, "covariances"_a, "colours"_a)
      .def("backward", &backward, "means"_a, "covariances"_a, "colours"_a, "lmbda"_a, "colour"_a, "shape"_a, "offset"_a,
           "steps"_a);
  nb::class_<sgi::FeatureFit>(m, "FeatureFit")
      .def(
          "__init__",
          [](sgi::FeatureFit *self, const std::string &isa, int threads, int per_seed, int channels, int features,
             int hidden, int context_hidden, const std::vector<int> &hash_resolutions, int hash_features,
             int hash_log2_entries) {
            require(per_seed >= 1 && channels >= 1 && features >= 1 && hidden >= 1, "a model has seeds of some size");
            require(context_hidden >= 1 && hash_features >= 1, "a context has inputs and hidden units");
            sgi::ContextSpec context;
            context.hash_resolutions = hash_resolutions;
            context.hash_features = hash_features;
            context.hash_log2_entries = hash_log2_entries;
            const sgi::FeatureModel model{per_seed, channels, features, hidden, context_hidden, 0};
            new (self) sgi::FeatureFit(sgi::choose_isa(isa), threads, model, context);
          },
          "isa"_a, "threads"_a, "per_seed"_a, "channels"_a, "features"_a, "hidden"_a, "context_hidden"_a,
          "hash_resolutions"_a, "hash_features"_a, "hash_log2_entries"_a)
      .def("set_layout", &set_pixels, "half_pixels"_a, "colour_step"_a, "width"_a, "height"_a)
      .def("forward", &draw_features, "feature"_a, "scales"_a, "offset"_a, "decoders"_a, "first"_a, "rest"_a,
           "tables"_a, "steps"_a, "rounding"_a, "priced"_a, "key"_a, "negative"_a, "scale"_a, "share"_a, "means"_a,
           "covariances"_a, "colours"_a)
      .def("backward", &descend_features, "means"_a, "covariances"_a, "colours"_a, "price"_a, "lmbda"_a, "feature"_a,
           "scales"_a, "offset"_a, "sums"_a, "tables"_a)
      .def("sums", [](const sgi::FeatureFit &self, bool priced) { return self.state().sums(priced); }, "priced"_a);
}
