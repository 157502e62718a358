#include <nanobind/stl/string.h>

#include <string>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "image/drain.hpp"
#include "image/local_variance.hpp"
#include "image/png_filter_kernel.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

void png_filter(Array<const uint8_t, 2> rows, Array<const uint8_t, 1> above, int step, Array<uint8_t, 2> out,
                const std::string &isa) {
  const size_t count = rows.shape(0), size = rows.shape(1);
  require(above.shape(0) == size && has_shape(out, count, size + 1) && step >= 1,
          "rows must be [n, bytes], above [bytes], out [n, 1 + bytes], step at least 1");
  const auto &kernel = sgi::kernel_for<sgi::PngFilterKernel>(sgi::choose_isa(isa));
  nb::gil_scoped_release release;
  kernel.filter(rows.data(), above.data(), int64_t(count), int64_t(size), step, out.data());
}

void local_variance(Array<const double, 2> plane, int radius, Array<double, 2> out) {
  require(has_shape(out, plane.shape(0), plane.shape(1)) && radius >= 0, "out must have the plane's shape");
  nb::gil_scoped_release release;
  sgi::local_variance(plane.data(), int64_t(plane.shape(0)), int64_t(plane.shape(1)), radius, out.data());
}

}  // namespace

void bind_image(nb::module_ &m) {
  m.def("png_filter", &png_filter, "rows"_a, "above"_a, "step"_a, "out"_a, "isa"_a = "auto");
  m.def("local_variance", &local_variance, "plane"_a, "radius"_a, "out"_a);
  nb::class_<sgi::Drain>(m, "Drain")
      .def(nb::init<int, int>(), "source"_a, "target"_a)
      .def("error", &sgi::Drain::error)
      .def("join", &sgi::Drain::join, nb::call_guard<nb::gil_scoped_release>());
}
