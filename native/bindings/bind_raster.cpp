#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <optional>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "raster/rasterizer.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;
using F32In2 = Array<const float, 2>;
using F32In3 = Array<const float, 3>;
using F32Out2 = Array<float, 2>;
using F32Out3 = Array<float, 3>;

namespace {

sgi::Gaussians gaussians(const F32In2 &means, const F32In2 &covariances, const F32In2 &colours) {
  const size_t n = means.shape(0);
  require(means.shape(1) == 2, "means must be [N, 2]");
  require(has_shape(covariances, n, 3), "covariances must be [N, 3]");
  require(colours.shape(0) == n && colours.shape(1) >= 1, "colours must be [N, C]");
  require(n < (size_t(1) << 31), "too many Gaussians");
  return {means.data(), covariances.data(), colours.data(), int64_t(n), int(colours.shape(1))};
}

// Of an image [C, H, W].
template <class A>
sgi::View view(const A &image, const sgi::Gaussians &g, int x0, int y0) {
  const size_t height = image.shape(1), width = image.shape(2);
  require(image.shape(0) == size_t(g.channels), "the image must have the colours' channels");
  require(height > 0 && width > 0, "image must not be empty");
  constexpr int kFar = 1 << 30;
  require(height < kFar && width < kFar && x0 > -kFar && x0 < kFar && y0 > -kFar && y0 < kFar,
          "image and origin must be smaller than 2^30 pixels");
  return {x0, y0, int(width), int(height)};
}

sgi::Gradients gradients(const sgi::Gaussians &g, F32Out2 &means, F32Out2 &covariances, F32Out2 &colours) {
  const size_t n = g.count;
  require(has_shape(means, n, 2) && has_shape(covariances, n, 3) && has_shape(colours, n, size_t(g.channels)),
          "gradients must have the shapes of the inputs");
  return {means.data(), covariances.data(), colours.data()};
}

void forward(sgi::Rasterizer &self, F32In2 means, F32In2 covariances, F32In2 colours, F32Out3 image, int x0, int y0,
             float cutoff) {
  const sgi::Gaussians g = gaussians(means, covariances, colours);
  const sgi::View v = view(image, g, x0, y0);
  nb::gil_scoped_release release;
  self.forward(g, v, cutoff, image.data());
}

std::pair<double, double> error(sgi::Rasterizer &self, F32In2 means, F32In2 covariances, F32In2 colours, F32In3 target,
                                int x0, int y0, float cutoff, bool absolute, float weight,
                                std::optional<F32In2> weights, F32Out2 grad_means, F32Out2 grad_covariances,
                                F32Out2 grad_colours) {
  const sgi::Gaussians g = gaussians(means, covariances, colours);
  const sgi::View v = view(target, g, x0, y0);
  require(!weights || has_shape(*weights, target.shape(1), target.shape(2)), "weights must be [H, W]");
  const sgi::Gradients out = gradients(g, grad_means, grad_covariances, grad_colours);
  const sgi::Comparison with{absolute ? sgi::Loss::kAbsolute : sgi::Loss::kSquared, target.data(),
                             weights ? weights->data() : nullptr, weight};
  nb::gil_scoped_release release;
  const sgi::Errors errors = self.error(g, v, cutoff, with, out);
  return {errors.loss, errors.squared};
}

}  // namespace

void bind_raster(nb::module_ &m) {
  nb::class_<sgi::Rasterizer>(m, "Rasterizer")
      .def(
          "__init__",
          [](sgi::Rasterizer *self, const std::string &isa, int threads, int64_t most_pairs) {
            new (self) sgi::Rasterizer(sgi::choose_isa(isa), threads, most_pairs);
          },
          "isa"_a, "threads"_a, "most_pairs"_a)
      .def("forward", &forward, "means"_a, "covariances"_a, "colours"_a, "image"_a, "x0"_a, "y0"_a, "cutoff"_a)
      .def("error", &error, "means"_a, "covariances"_a, "colours"_a, "target"_a, "x0"_a, "y0"_a, "cutoff"_a,
           "absolute"_a, "weight"_a, "weights"_a.none(), "grad_means"_a, "grad_covariances"_a, "grad_colours"_a)
      .def_prop_ro("isa", [](const sgi::Rasterizer &self) { return std::string(sgi::name_of(self.isa())); })
      .def_prop_ro("pairs", &sgi::Rasterizer::pairs);
}
