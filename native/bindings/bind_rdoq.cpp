#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <optional>

#include "bindings/bindings.hpp"
#include "bindings/tile_models.hpp"
#include "rdoq/coordinate_descent.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

// None where all are 1.
using Weights = std::optional<Array<const float, 2>>;

sgi::Residual residual_of(const Array<float, 3> &samples, const Weights &weights, size_t channels) {
  require(samples.shape(0) == channels && samples.shape(1) > 0 && samples.shape(2) > sgi::kWindowPadding &&
              samples.shape(1) < (1 << 30) && samples.shape(2) < (1 << 30),
          "residual must be [C, H, W + padding]");
  require(!weights || has_shape(*weights, samples.shape(1), samples.shape(2)), "weights must be [H, W + padding]");
  const int row = int(samples.shape(2)), width = row - sgi::kWindowPadding;
  return {samples.data(), int(channels), int(samples.shape(1)), width, row, weights ? weights->data() : nullptr};
}

auto search_seeds(const nb::bytes &header, nb::handle model, Array<float, 3> residual, Weights weights, float lmbda,
                  float cutoff, int deep, int threads, const std::string &isa) {
  const sgi::SeedCoding coding(header, model, isa);
  const sgi::ModelSpec &spec = coding.header.spec;
  const size_t n = coding.tile.log_size.size(), d = size_t(spec.attributes()), channels = size_t(spec.channels);
  require(spec.is_plain() && channels <= size_t(sgi::kMaxChannels),
          "seeds must hold their Gaussians, of 64 channels at most");
  const std::vector<double> values = sgi::attributes_of(coding.header, model);
  const sgi::Residual left = residual_of(residual, weights, channels);
  std::vector<int64_t> decoded(n * d);
  std::vector<double> change(n);
  {
    const nb::gil_scoped_release release;
    sgi::search_seeds(coding.seeds, {coding.model}, {lmbda, cutoff, deep}, left, values.data(),
                      {decoded.data(), change.data()}, threads);
  }
  return std::tuple(sgi::as_array<int64_t>(std::move(decoded), std::array{n, d}),
                    sgi::as_array<double>(std::move(change), std::array{n}));
}

}  // namespace

void bind_rdoq(nb::module_ &m) {
  m.def(
      "search_seeds", &search_seeds, "header"_a, "model"_a, "residual"_a, "weights"_a, "lmbda"_a, "cutoff"_a, "deep"_a,
      "threads"_a, "isa"_a,
      "Attributes [N, C + 5] of a TileModel in 2^-24 and the change of cost [N]; `residual` becomes what they leave.");
}
