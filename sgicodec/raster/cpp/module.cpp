// Python bindings: arrays in, arrays out; no link against torch or numpy.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <stdexcept>

#include "../../bitstream/cpp/bind_bitstream.hpp"
#include "../../fit/cpp/bind_seed_fit.hpp"
#include "../../model/cpp/bind_model.hpp"
#include "neighbours.hpp"
#include "peak.hpp"
#include "rasterizer.hpp"
#include "thread_pool.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using F32In2 = nb::ndarray<const float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using F32In3 = nb::ndarray<const float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using F32Out2 = nb::ndarray<float, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using F32Out3 = nb::ndarray<float, nb::ndim<3>, nb::c_contig, nb::device::cpu>;
using I32In2 = nb::ndarray<const int32_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using I32Out2 = nb::ndarray<int32_t, nb::ndim<2>, nb::c_contig, nb::device::cpu>;

namespace {

void require(bool ok, const char *what) {
  if (!ok) throw std::invalid_argument(what);
}

sgi::Gaussians gaussians(const F32In2 &means, const F32In2 &covariances, const F32In2 &colours) {
  const size_t n = means.shape(0);
  require(means.shape(1) == 2, "means must be [N, 2]");
  require(covariances.shape(0) == n && covariances.shape(1) == 3, "covariances must be [N, 3]");
  require(colours.shape(0) == n && colours.shape(1) >= 1, "colours must be [N, C]");
  require(n < (size_t(1) << 31), "too many Gaussians");
  return {means.data(), covariances.data(), colours.data(), int64_t(n), int(colours.shape(1))};
}

template <class Array>
sgi::View view(const Array &image, const sgi::Gaussians &g, int x0, int y0) {
  require(int(image.shape(0)) == g.channels, "image must be [C, H, W] with the colours' C");
  require(image.shape(1) > 0 && image.shape(2) > 0, "image must not be empty");
  constexpr int kFar = 1 << 30;
  require(image.shape(1) < kFar && image.shape(2) < kFar && x0 > -kFar && x0 < kFar && y0 > -kFar && y0 < kFar,
          "image and origin must be smaller than 2^30 pixels");
  return {x0, y0, int(image.shape(2)), int(image.shape(1))};
}

sgi::Gradients gradients(const sgi::Gaussians &g, F32Out2 &means, F32Out2 &covariances, F32Out2 &colours) {
  const size_t n = g.count;
  require(means.shape(0) == n && means.shape(1) == 2 && covariances.shape(0) == n && covariances.shape(1) == 3 &&
              colours.shape(0) == n && int(colours.shape(1)) == g.channels,
          "gradients must have the shapes of the inputs");
  return {means.data(), covariances.data(), colours.data()};
}

}  // namespace

NB_MODULE(_native, m) {
  bind_bitstream(m);
  bind_model(m);
  nb::class_<sgi::Rasterizer>(m, "Rasterizer")
      .def(nb::init<const std::string &, int, int64_t>(), "isa"_a, "threads"_a, "most_pairs"_a)
      .def("forward",
           [](sgi::Rasterizer &self, F32In2 means, F32In2 covariances, F32In2 colours, F32Out3 image, int x0, int y0,
              float cutoff) {
             const sgi::Gaussians g = gaussians(means, covariances, colours);
             const sgi::View v = view(image, g, x0, y0);
             nb::gil_scoped_release release;
             self.forward(g, v, cutoff, image.data());
           })
      .def("backward",
           [](sgi::Rasterizer &self, F32In2 means, F32In2 covariances, F32In2 colours, F32In3 grad, int x0, int y0,
              F32Out2 grad_means, F32Out2 grad_covariances, F32Out2 grad_colours) {
             const sgi::Gaussians g = gaussians(means, covariances, colours);
             const sgi::View v = view(grad, g, x0, y0);
             const sgi::Gradients out = gradients(g, grad_means, grad_covariances, grad_colours);
             nb::gil_scoped_release release;
             self.backward(g, v, grad.data(), out);
           })
      .def("squared_error",
           [](sgi::Rasterizer &self, F32In2 means, F32In2 covariances, F32In2 colours, F32In3 target, int x0, int y0,
              float cutoff, float weight, F32Out2 grad_means, F32Out2 grad_covariances, F32Out2 grad_colours) {
             const sgi::Gaussians g = gaussians(means, covariances, colours);
             const sgi::View v = view(target, g, x0, y0);
             const sgi::Gradients out = gradients(g, grad_means, grad_covariances, grad_colours);
             nb::gil_scoped_release release;
             return self.squared_error(g, v, cutoff, target.data(), weight, out);
           })
      .def_prop_ro("isa", [](const sgi::Rasterizer &self) { return std::string(self.kernel().name); })
      .def_prop_ro("pairs", &sgi::Rasterizer::pairs);

  m.def("nearest_neighbours", [](I32In2 points, I32In2 queries, I32Out2 out, int threads) {
    require(points.shape(1) == 2 && queries.shape(1) == 2 && out.shape(0) == queries.shape(0) && out.shape(1) > 0,
            "points [N, 2], queries [M, 2], out [M, k]");
    nb::gil_scoped_release release;
    sgi::nearest_neighbours(points.data(), int64_t(points.shape(0)), queries.data(), int64_t(queries.shape(0)),
                            int(out.shape(1)), threads, out.data());
  });
  bind_seed_fit(m);
  m.def("resolve_threads", &sgi::resolve_threads);
  m.def("fma_peak", &sgi::fma_peak, nb::call_guard<nb::gil_scoped_release>());
}
