#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "model/cell_sums.hpp"
#include "model/hash_grid.hpp"
#include "model/seed_gaussians.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

template <class T, int D>
using Strided = nb::ndarray<T, nb::ndim<D>, nb::device::cpu>;  // rows apart, each contiguous

void evaluate_network(Array<const int64_t, 2> w1, Array<const int64_t, 1> b1, Array<const int64_t, 2> w2,
                      Array<const int64_t, 1> b2, int shift, int predicted, Strided<const int16_t, 2> inputs,
                      const std::string &isa, Array<int64_t, 2> out) {
  const sgi::Network network(sgi::network_of(w1, b1, w2, b2, shift, predicted), sgi::choose_isa(isa));
  const size_t n = inputs.shape(0);
  require(inputs.shape(1) == w1.shape(1) && (n == 0 || inputs.stride(1) == 1 || inputs.shape(1) < 2),
          "inputs must be rows [n, inputs]");
  require(has_shape(out, n, size_t(network.outputs())), "out must be [n, outputs]");
  std::vector<double> scratch(size_t(network.scratch_size()));
  network.evaluate(inputs.data(), inputs.stride(0), int64_t(n), scratch.data(), out.data());
}

auto cell_sums(Array<const float, 3> detail, std::optional<Array<const float, 2>> weights, int root_log, int threads) {
  const size_t channels = detail.shape(0), height = detail.shape(1), width = detail.shape(2);
  require(detail.size() > 0 && root_log >= 1 && root_log < 16, "samples must not be empty, roots have two pixels");
  require(!weights || has_shape(*weights, height, width), "weights must be [H, W]");
  std::vector<sgi::CellSums> levels;
  {
    const nb::gil_scoped_release release;
    levels = sgi::cell_sums(
        {detail.data(), weights ? weights->data() : nullptr, int64_t(channels), int64_t(height), int64_t(width)},
        root_log, threads);
  }
  const auto arrays = [&](sgi::CellSums &of) {
    const auto rows = size_t(of.rows), columns = size_t(of.columns);
    return std::tuple(sgi::as_array<double>(std::move(of.values), std::array{channels, rows, columns}),
                      sgi::as_array<double>(std::move(of.squares), std::array{rows, columns}),
                      sgi::as_array<double>(std::move(of.weights), std::array{rows, columns}));
  };
  std::vector<decltype(arrays(levels[0]))> found;
  for (sgi::CellSums &of : levels) found.push_back(arrays(of));
  return found;
}

void seed_gaussians(Array<const double, 2> values, Array<const int32_t, 2> half_pixels, Array<const int8_t, 1> log_size,
                    int threads, const std::string &isa, Array<float, 2> means, Array<float, 2> covariances,
                    Array<float, 2> colours) {
  const size_t n = log_size.shape(0), channels = colours.shape(1);
  const sgi::SeedModel model{int(channels)};
  require(channels >= 1 && has_shape(values, n, size_t(model.attributes())) && has_shape(half_pixels, n, 2),
          "values must be [N, C + 5], half_pixels [N, 2]");
  require(has_shape(means, n, 2) && has_shape(covariances, n, 3) && has_shape(colours, n, channels),
          "means [N, 2], covariances [N, 3], colours [N, C]");
  sgi::require_cells(log_size);
  nb::gil_scoped_release release;
  sgi::seed_gaussians(model, {half_pixels.data(), log_size.data()}, int64_t(n), values.data(), threads,
                      sgi::choose_isa(isa), {means.data(), covariances.data(), colours.data()});
}

void make_hash_grid(sgi::HashGrid *self, std::vector<int> resolutions, int features, int log2_entries, int64_t width,
                    int64_t height) {
  require(width > 0 && height > 0 && log2_entries >= 0 && log2_entries < 32, "a picture has pixels, a table entries");
  sgi::ContextSpec context;
  context.hash_resolutions = std::move(resolutions);
  context.hash_features = features, context.hash_log2_entries = log2_entries;
  new (self) sgi::HashGrid(context, width, height);
}

auto hash_corners(const sgi::HashGrid &grid, Array<const int32_t, 2> half_pixels) {
  const size_t n = half_pixels.shape(0), levels = size_t(grid.resolutions());
  require(has_shape(half_pixels, n, 2), "half_pixels must be [N, 2]");
  std::vector<int64_t> entries(n * levels * 4);
  std::vector<int> weights(entries.size());
  for (size_t at = 0; at < n * levels; ++at)
    grid.corners(int(at % levels), half_pixels.data() + 2 * (at / levels), &entries[4 * at], &weights[4 * at]);
  const std::array shape{n, levels, size_t(4)};
  return std::tuple(sgi::as_array<int64_t>(std::move(entries), shape), sgi::as_array<int>(std::move(weights), shape));
}

}  // namespace

void bind_model(nb::module_ &m) {
  m.def("cell_sums", &cell_sums, "detail"_a, "weights"_a.none(), "root_log"_a, "threads"_a,
        "Sums over cells of 2 pixels that fill whole roots: values [C, rows, columns], squares and weights.");
  m.def("seed_gaussians", &seed_gaussians, "values"_a, "half_pixels"_a, "log_size"_a, "threads"_a, "isa"_a, "means"_a,
        "covariances"_a, "colours"_a);
  m.def("evaluate_network", &evaluate_network, "w1"_a, "b1"_a, "w2"_a, "b2"_a, "shift"_a, "predicted"_a, "inputs"_a,
        "isa"_a, "out"_a);
  nb::class_<sgi::HashGrid>(m, "HashGrid", "The binary hash grid H of a picture.")
      .def("__init__", &make_hash_grid, "resolutions"_a, "features"_a, "log2_entries"_a, "width"_a, "height"_a)
      .def_prop_ro("counts", &sgi::HashGrid::counts, "Signs of every resolution.")
      .def("corners", &hash_corners, "half_pixels"_a,
           "The entries around each seed in the table of every resolution [N, L, 4], and their weights in 2^-12.");
}
