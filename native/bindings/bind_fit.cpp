#include <nanobind/stl/string.h>

#include <algorithm>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "fit/adam.hpp"
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
                Array<const int32_t, 2> neighbour, int quality) {
  const int64_t n = int64_t(log_size.shape(0)), k = int64_t(neighbour.shape(1));
  require_rows(half_pixels, n, 2, "half_pixels must be [N, 2]");
  require_rows(neighbour, n, k, "neighbour must be [N, k]");
  require(k <= sgi::kMostNeighbours, "there are more neighbours than weights for them");
  sgi::require_cells(log_size);
  for (int64_t i = 0; i < n * k; ++i) require(neighbour.data()[i] < n, "a neighbour is no seed");
  self.set_layout({half_pixels.data(), log_size.data()}, n, neighbour.data(), int(k), quality);
}

double forward(sgi::SeedFit &self, In2 colour, In2 shape, In2 offset, In1 first, In1 rest, In1 steps, int rounding,
               uint32_t key, bool negative, int reuse, bool trains_first, Out2 means, Out2 covariances, Out2 colours) {
  const sgi::SeedState &s = self.state();
  const int64_t gaussians = s.count * s.per_seed;
  require_rows(colour, s.count, s.group_size(0), "colour must be [N, K C]");
  require_rows(shape, s.count, s.group_size(1), "shape must be [N, 3 K]");
  require_rows(offset, s.count, s.group_size(2), "offset must be [N, 2 K]");
  require(int64_t(first.shape(0)) == self.first_size(), "first holds W1 of all groups");
  require(int64_t(rest.shape(0)) == self.rest_size(), "rest holds b1, W2 and b2 of all groups");
  require(int64_t(steps.shape(0)) == sgi::kUnits * sgi::kLevels + sgi::kGammas, "steps holds base steps and gamma");
  require(rounding >= 0 && rounding <= 2, "rounding is 0, 1 or 2");
  require(reuse >= 0 && reuse <= 2, "reuse is 0, 1 or 2");
  require_rows(means, gaussians, 2, "means must be [N K, 2]");
  require_rows(covariances, gaussians, 3, "covariances must be [N K, 3]");
  require_rows(colours, gaussians, s.channels, "colours must be [N K, C]");
  const sgi::SeedGaussians out{means.data(), covariances.data(), colours.data()};
  nb::gil_scoped_release release;
  return self.forward({colour.data(), shape.data(), offset.data()}, {first.data(), rest.data(), steps.data()},
                      sgi::Rounding(rounding), {key, negative}, sgi::Reuse(reuse), trains_first, out);
}

void backward(sgi::SeedFit &self, In2 means, In2 covariances, In2 colours, float lmbda, Out2 colour, Out2 shape,
              Out2 offset, Out1 sums) {
  const sgi::SeedState &s = self.state();
  const int64_t gaussians = s.count * s.per_seed;
  require_rows(means, gaussians, 2, "gradients of means must be [N K, 2]");
  require_rows(covariances, gaussians, 3, "gradients of covariances must be [N K, 3]");
  require_rows(colours, gaussians, s.channels, "gradients of colours must be [N K, C]");
  require_rows(colour, s.count, s.group_size(0), "colour must be [N, K C]");
  require_rows(shape, s.count, s.group_size(1), "shape must be [N, 3 K]");
  require_rows(offset, s.count, s.group_size(2), "offset must be [N, 2 K]");
  require(int64_t(sums.shape(0)) == self.sums(), "sums has another length");
  const sgi::SeedGradients g{
      means.data(), covariances.data(), colours.data(), lmbda, {colour.data(), shape.data(), offset.data()}};
  nb::gil_scoped_release release;
  self.backward(g, sums.data());
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
  nb::class_<sgi::SeedFit>(m, "SeedFit")
      .def(
          "__init__",
          [](sgi::SeedFit *self, const std::string &isa, int threads, int per_seed, int hidden, In2 opponent) {
            require(per_seed >= 1 && hidden >= 1 && opponent.shape(0) == opponent.shape(1), "opponent must be [C, C]");
            new (self)
                sgi::SeedFit(sgi::choose_isa(isa), threads, per_seed, int(opponent.shape(0)), hidden, opponent.data());
          },
          "isa"_a, "threads"_a, "per_seed"_a, "hidden"_a, "opponent"_a)
      .def("set_layout", &set_layout, "half_pixels"_a, "log_size"_a, "neighbour"_a, "quality"_a)
      .def("forward", &forward, "colour"_a, "shape"_a, "offset"_a, "first"_a, "rest"_a, "steps"_a, "rounding"_a,
           "key"_a, "negative"_a, "reuse"_a, "trains_first"_a, "means"_a, "covariances"_a, "colours"_a)
      .def("backward", &backward, "means"_a, "covariances"_a, "colours"_a, "lmbda"_a, "colour"_a, "shape"_a, "offset"_a,
           "sums"_a)
      .def(
          "bits",
          [](const sgi::SeedFit &self, Out1 out) {
            require(out.shape(0) == self.bits().size(), "bits must be [N]");
            std::copy(self.bits().begin(), self.bits().end(), out.data());
          },
          "out"_a)
      .def_prop_ro("sums", &sgi::SeedFit::sums);
}
