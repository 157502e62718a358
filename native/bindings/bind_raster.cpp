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
using F32In1 = Array<const float, 1>;
using I32In1 = Array<const int32_t, 1>;
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

sgi::View view_of(size_t channels, size_t given, size_t height, size_t width, int x0, int y0) {
  require(given == channels, "the image must have the colours' channels");
  require(height > 0 && width > 0, "image must not be empty");
  constexpr int kFar = 1 << 30;
  require(height < kFar && width < kFar && x0 > -kFar && x0 < kFar && y0 > -kFar && y0 < kFar,
          "image and origin must be smaller than 2^30 pixels");
  return {x0, y0, int(width), int(height)};
}

// Of an image [C, H, W].
template <class A>
sgi::View view(const A &image, const sgi::Gaussians &g, int x0, int y0) {
  return view_of(size_t(g.channels), image.shape(0), image.shape(1), image.shape(2), x0, y0);
}

sgi::Gradients gradients(const sgi::Gaussians &g, F32Out2 &means, F32Out2 &covariances, F32Out2 &colours) {
  const size_t n = g.count;
  require(has_shape(means, n, 2) && has_shape(covariances, n, 3) && has_shape(colours, n, size_t(g.channels)),
          "gradients must have the shapes of the inputs");
  return {means.data(), covariances.data(), colours.data()};
}

// Any of the three sample types, rows apart.
using Pixels = nb::ndarray<nb::ndim<3>, nb::device::cpu>;

sgi::Samples samples(const Pixels &out, const F32In1 &low, const F32In1 &span, bool clip) {
  const size_t channels = out.shape(2);
  require(channels <= sgi::kMaxDrawnChannels && low.shape(0) == channels && span.shape(0) == channels,
          "low and span must be [C], C at most 64");
  require((out.shape(2) < 2 || out.stride(2) == 1) && (out.shape(1) < 2 || out.stride(1) == int64_t(channels)),
          "a row of samples must be contiguous");
  const nb::dlpack::dtype type = out.dtype();
  require(type == nb::dtype<uint8_t>() || type == nb::dtype<uint16_t>() || type == nb::dtype<float>(),
          "samples must be uint8, uint16 or float32");
  const sgi::SampleType kind = type == nb::dtype<uint8_t>()    ? sgi::SampleType::u8
                               : type == nb::dtype<uint16_t>() ? sgi::SampleType::u16
                                                               : sgi::SampleType::f32;
  require(clip || kind == sgi::SampleType::f32, "integers must be clipped");
  return {out.data(), out.stride(0), kind, low.data(), span.data(), clip};
}

sgi::Background background(const F32In3 &lines, const I32In1 &top, const F32In2 &down,
                           const std::optional<F32In3> &planes, const Pixels &out) {
  const size_t height = out.shape(0);
  sgi::Background behind{};
  if (planes) {
    require(planes->shape(0) == out.shape(2) && planes->shape(1) == height && planes->shape(2) == out.shape(1),
            "planes must be [C, height, width]");
    behind.planes = planes->data();
    behind.height = int64_t(height);
    behind.plane_width = int64_t(out.shape(1));
  }
  if (lines.size() == 0) return behind;
  const size_t taps = down.shape(1);
  require(lines.shape(0) == out.shape(2) && lines.shape(2) == out.shape(1) && top.shape(0) == height &&
              down.shape(0) == height,
          "background must be lines [C, count, width], top [height], down [height, taps]");
  for (size_t y = 0; y < height; ++y)
    require(top.data()[y] >= 0 && size_t(top.data()[y]) + taps <= lines.shape(1), "top must be lines");
  behind.lines = lines.data();
  behind.count = int64_t(lines.shape(1));
  behind.width = int64_t(lines.shape(2));
  behind.top = top.data();
  behind.down = down.data();
  behind.taps = int(taps);
  return behind;
}

void forward(sgi::Rasterizer &self, F32In2 means, F32In2 covariances, F32In2 colours, F32Out3 image, int x0, int y0,
             float cutoff) {
  const sgi::Gaussians g = gaussians(means, covariances, colours);
  const sgi::View v = view(image, g, x0, y0);
  nb::gil_scoped_release release;
  self.forward(g, v, cutoff, image.data());
}

void draw(sgi::Rasterizer &self, F32In2 means, F32In2 covariances, F32In2 colours, Pixels out, int x0, int y0,
          float cutoff, F32In3 lines, I32In1 top, F32In2 down, std::optional<F32In3> planes, F32In1 low, F32In1 span,
          bool clip) {
  const sgi::Gaussians g = gaussians(means, covariances, colours);
  const sgi::View v = view_of(size_t(g.channels), out.shape(2), out.shape(0), out.shape(1), x0, y0);
  const sgi::Samples to = samples(out, low, span, clip);
  const sgi::Background behind = background(lines, top, down, planes, out);
  nb::gil_scoped_release release;
  self.draw(g, v, cutoff, behind, to);
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
      .def("draw", &draw, "means"_a, "covariances"_a, "colours"_a, "out"_a, "x0"_a, "y0"_a, "cutoff"_a, "lines"_a,
           "top"_a, "down"_a, "planes"_a.none(), "low"_a, "span"_a, "clip"_a)
      .def("error", &error, "means"_a, "covariances"_a, "colours"_a, "target"_a, "x0"_a, "y0"_a, "cutoff"_a,
           "absolute"_a, "weight"_a, "weights"_a.none(), "grad_means"_a, "grad_covariances"_a, "grad_colours"_a)
      .def_prop_ro("isa", [](const sgi::Rasterizer &self) { return std::string(sgi::name_of(self.isa())); })
      .def_prop_ro("pairs", &sgi::Rasterizer::pairs);
}
