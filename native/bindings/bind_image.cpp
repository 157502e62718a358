#include <nanobind/stl/string.h>

#include <string>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "image/drain.hpp"
#include "image/halve.hpp"
#include "image/local_variance.hpp"
#include "image/png_filter_kernel.hpp"
#include "image/regular_patterns.hpp"

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

auto halved(Array<const float, 3> planes) {
  const size_t channels = planes.shape(0), height = planes.shape(1), width = planes.shape(2);
  require(height > 0 && width > 0, "planes have pixels");
  std::vector<float> half(channels * ((height + 1) / 2) * ((width + 1) / 2));
  {
    nb::gil_scoped_release release;
    sgi::halve(planes.data(), int64_t(channels), int64_t(height), int64_t(width), half.data());
  }
  return sgi::as_array<float>(std::move(half), std::array{channels, (height + 1) / 2, (width + 1) / 2});
}

using Lines = Array<const int32_t, 1>;

// plane: with what lies around the blocks, up to the end of the last lanes of them.
void regular_patterns(Array<const float, 2> plane, Array<const float, 2> waves, Lines own, Lines own_end, Lines others,
                      Lines others_end, float noise, float doubtful, Array<float, 2> ratio, Array<float, 2> power,
                      Array<int32_t, 2> number, int threads, const std::string &isa) {
  const size_t rows = ratio.shape(0), columns = ratio.shape(1), count = own_end.size();
  const sgi::Isa set = sgi::choose_isa(isa);
  const size_t lanes = size_t(sgi::lanes_of(set)), whole = (columns + lanes - 1) / lanes * lanes;
  const size_t beyond = sgi::kPatternWindow - sgi::kPatternBlock;
  require(plane.shape(0) >= rows * sgi::kPatternBlock + beyond && plane.shape(1) >= whole * sgi::kPatternBlock + beyond,
          "the plane must reach around all blocks");
  require(has_shape(waves, 2 * sgi::kPatternWaves, sgi::kPatternWaves) && others_end.size() == count &&
              has_shape(power, rows, columns) && has_shape(number, rows, columns),
          "waves [24, 12], patterns [P], blocks [rows, columns]");
  const auto checked = [](const Lines &frequencies, const Lines &ends) {
    int32_t last = 0;
    for (size_t i = 0; i < ends.size(); last = ends(i++)) require(ends(i) >= last, "ends must ascend");
    require(size_t(last) <= frequencies.size(), "ends must lie in the frequencies");
    for (size_t i = 0; i < frequencies.size(); ++i)
      require(frequencies(i) >= 0 && frequencies(i) < sgi::kPatternFrequencies, "frequencies must be 0..287");
    return frequencies.data();
  };
  const sgi::Patterns patterns{
      int(count), waves.data(), checked(own, own_end), own_end.data(), checked(others, others_end), others_end.data(),
      noise,      doubtful};
  nb::gil_scoped_release release;
  sgi::find_regular_patterns(patterns, plane.data(), int64_t(plane.shape(1)), int64_t(rows), int64_t(columns), threads,
                             set, ratio.data(), power.data(), number.data());
}

}  // namespace

void bind_image(nb::module_ &m) {
  m.def("png_filter", &png_filter, "rows"_a, "above"_a, "step"_a, "out"_a, "isa"_a = "auto");
  m.def("local_variance", &local_variance, "plane"_a, "radius"_a, "out"_a);
  m.def("halved", &halved, "planes"_a, "Planes [C, H, W] at half their size, filtered with (1, 3, 3, 1) / 8.");
  m.def("regular_patterns", &regular_patterns, "plane"_a, "waves"_a, "own"_a, "own_end"_a, "others"_a, "others_end"_a,
        "noise"_a, "doubtful"_a, "ratio"_a, "power"_a, "number"_a, "threads"_a, "isa"_a,
        "Of each block the pattern that stands out most: ratio of powers, power, number.");
  nb::class_<sgi::Drain>(m, "Drain")
      .def(nb::init<int, int>(), "source"_a, "target"_a)
      .def("error", &sgi::Drain::error)
      .def("join", &sgi::Drain::join, nb::call_guard<nb::gil_scoped_release>());
}
