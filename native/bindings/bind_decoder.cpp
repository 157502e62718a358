#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bindings/python_source.hpp"
#include "bitstream/file_source.hpp"
#include "decoder/stream.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::as_bytes;
using sgi::require;

namespace {

using Released = nb::call_guard<nb::gil_scoped_release>;
using ViewFields = std::tuple<double, double, double, double, int64_t, int64_t>;

sgi::PictureView view_of(const ViewFields &fields) {
  const auto &[x, y, sx, sy, columns, rows] = fields;
  require(sx > 0 && sy > 0 && columns > 0 && rows > 0 && columns <= sgi::kMaxSide, "a view must have pixels");
  return {x, y, sx, sy, columns, rows};
}

ViewFields fields_of(const sgi::PictureView &v) { return {v.x, v.y, v.sx, v.sy, v.columns, v.rows}; }

// Lets Ctrl-C through, now and then: whoever else runs Python is not waited for at every tile.
void check_signals() {
  using Clock = std::chrono::steady_clock;
  thread_local Clock::time_point last;
  const Clock::time_point now = Clock::now();
  if (now - last < std::chrono::milliseconds(50)) return;
  last = now;
  const nb::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals()) throw nb::python_error();
}

// An integer is the descriptor of a file that can seek.
std::unique_ptr<sgi::ByteSource> source_of(const nb::object &source) {
  if (nb::isinstance<nb::int_>(source))
    if (auto file = sgi::file_source(nb::cast<int>(source))) return file;
  return sgi::python_source(source);
}

void open(sgi::Stream *self, const nb::object &source, int threads, const std::string &isa, int64_t cache_bytes,
          int64_t block_samples, bool checked) {
  require(block_samples >= 1 && block_samples <= int64_t(1) << 31, "block_samples must be 1 to 2^31");
  const sgi::DecoderSettings settings{threads,       sgi::choose_isa(isa), cache_bytes,
                                      block_samples, check_signals,        checked};
  auto bytes = source_of(source);
  const nb::gil_scoped_release release;
  new (self) sgi::Stream(std::move(bytes), settings);
}

nb::dict blobs(const sgi::Stream &self) {
  nb::dict found;
  for (const auto &[letter, bytes] : self.chunks().blobs()) found[nb::str(&letter, 1)] = as_bytes(bytes);
  return found;
}

nb::dict chunk_bytes(const sgi::Stream &self) {
  nb::dict found;
  for (const auto &[name, bytes] : self.chunks().chunk_bytes()) found[name.c_str()] = bytes;
  return found;
}

nb::bytes tile(sgi::Stream &self, int64_t number) {
  require(number >= 0 && number < self.header().grid().count(), "there is no such tile");
  std::vector<uint8_t> payload;
  {
    const nb::gil_scoped_release release;
    payload = self.tile(number);
  }
  return as_bytes(payload);
}

auto tiles(sgi::Stream &self) {
  const nb::gil_scoped_release release;
  const sgi::Stream::Tiles found = self.tiles();
  return std::tuple(found.held, found.decoded, found.ahead);
}

template <class T>
nb::object drawn(sgi::Stream &self, const sgi::PictureView &view, int64_t top, int64_t rows, sgi::Output output,
                 const sgi::DrawOptions &options) {
  const size_t channels = size_t(self.header().spec.channels);
  const size_t shape[] = {size_t(rows), size_t(view.columns), channels};
  std::unique_ptr<T[]> samples(new T[shape[0] * shape[1] * channels]);
  {
    const nb::gil_scoped_release release;
    self.draw(view, top, rows, output, options, samples.get(), view.columns * int64_t(channels * sizeof(T)));
  }
  T *data = samples.get();
  const nb::capsule owner(samples.release(), [](void *held) noexcept { delete[] static_cast<T *>(held); });
  return nb::cast(nb::ndarray<nb::numpy, T, nb::ndim<3>>(data, 3, shape, owner));
}

nb::object draw(sgi::Stream &self, const ViewFields &fields, int64_t top, int64_t rows, const std::string &type,
                bool mapped, bool exact, bool dither, bool lossy) {
  const sgi::DrawOptions options{exact, dither, lossy};
  const sgi::PictureView view = view_of(fields);
  require(top >= 0 && rows > 0 && rows <= sgi::kMaxSide, "top and rows must be rows of the view");
  require(mapped || type == "float32", "values are float32");
  if (type == "uint8") return drawn<uint8_t>(self, view, top, rows, sgi::SampleType::u8, options);
  if (type == "uint16") return drawn<uint16_t>(self, view, top, rows, sgi::SampleType::u16, options);
  require(type == "float32", "samples must be uint8, uint16 or float32");
  return drawn<float>(self, view, top, rows, mapped ? sgi::SampleType::f32 : sgi::kValues, options);
}

auto survey(sgi::Stream &self) {
  const sgi::Survey &found = [&]() -> const sgi::Survey & {
    const nb::gil_scoped_release release;
    return self.survey();
  }();
  return std::tuple(found.seeds, std::vector<double>(found.part_bytes.begin(), found.part_bytes.end()),
                    found.mask_bytes, found.symbol_crc,
                    std::vector<int64_t>(found.texture_cells, found.texture_cells + 3));
}

nb::list levels(int64_t width, int64_t height) {
  nb::list found;
  for (const sgi::Level &level : sgi::levels_of(width, height))
    found.append(nb::make_tuple(level.width, level.height, level.downsample));
  return found;
}

}  // namespace

void bind_decoder(nb::module_ &m) {
  nb::class_<sgi::Stream>(m, "Stream")
      .def("__init__", &open, "source"_a, "threads"_a, "isa"_a, "cache_bytes"_a, "block_samples"_a = int64_t(1) << 27,
           "checked"_a = true)
      .def_prop_ro("size", [](const sgi::Stream &self) { return self.chunks().size(); })
      .def_prop_ro("blobs", &blobs)
      .def_prop_ro("chunk_bytes", &chunk_bytes)
      .def_prop_ro("max_error", &sgi::Stream::max_error, Released(), "-1 where nothing is said of all samples.")
      .def_prop_ro("graphics_error", &sgi::Stream::graphics_error, Released(),
                   "-1 where nothing is said of text alone.")
      .def_prop_ro("exact_bands", &sgi::Stream::exact_bands, Released(), "Empty where all bands are alike.")
      .def_prop_ro("has_exact_views", &sgi::Stream::has_exact_views, Released())
      .def_prop_ro("has_exact_alpha", &sgi::Stream::has_exact_alpha, Released())
      .def_prop_ro("has_overview", &sgi::Stream::has_overview)
      .def_prop_ro("overview", &sgi::Stream::overview, Released(), nb::rv_policy::reference_internal)
      .def_prop_ro("overview_bytes", [](const sgi::Stream &self) { return as_bytes(self.overview_bytes()); })
      .def("tiles", &tiles, "Decoded ones that are kept; decoded so far, to be drawn; of these before they were drawn.")
      .def("tile", &tile, "number"_a, "The payload of its chunk.")
      .def("set_blank", &sgi::Stream::set_blank, "sample"_a, Released())
      .def(
          "prepare",
          [](sgi::Stream &self, const ViewFields &fields, bool exact) { self.prepare(view_of(fields), exact); },
          "view"_a, "exact"_a, Released())
      .def("draw", &draw, "view"_a, "top"_a, "rows"_a, "sample_type"_a, "mapped"_a, "exact"_a, "dither"_a, "lossy"_a,
           nb::sig("def draw(self, view: tuple[float, float, float, float, int, int], top: int, rows: int, "
                   "sample_type: str, mapped: bool, exact: bool, dither: bool, lossy: bool) -> numpy.typing.NDArray"),
           "Samples [rows, columns, C] of a view (x, y, sx, sy, columns, rows) from its row `top` on. numpy is not "
           "needed before they are drawn.")
      .def("check_residual", &sgi::Stream::check_residual, Released(), "The CRC of the residual layer's chunk.")
      .def("survey", &survey, "Seeds, bytes of parts in their order, bytes of masks, checksum, cells of texture.");
  m.def("levels", &levels, "width"_a, "height"_a, "Width, height and downsampling of the levels of a pyramid.");
  m.def(
      "overview_size",
      [](int64_t width, int64_t height) {
        const sgi::Level size = sgi::overview_size(width, height);
        return std::tuple(size.width, size.height);
      },
      "width"_a, "height"_a, "Columns and rows of a picture's overview.");
  m.def(
      "inner_view",
      [](const ViewFields &fields, int64_t width, int64_t height) {
        const sgi::InnerView found = sgi::inner_view(view_of(fields), width, height);
        return std::tuple(fields_of(found.view), found.left, found.top);
      },
      "view"_a, "width"_a, "height"_a, "The part of a view in a picture of this size, and its first column and row.");
  m.def(
      "overview_view",
      [](const ViewFields &fields, int64_t width, int64_t height) {
        const auto found = sgi::overview_view(width, height, view_of(fields));
        return found ? std::optional(fields_of(*found)) : std::nullopt;
      },
      "view"_a, "width"_a, "height"_a, "What of the overview of a picture a view shows; None for more than it holds.");
}
