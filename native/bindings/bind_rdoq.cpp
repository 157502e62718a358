#include <nanobind/stl/optional.h>

#include <optional>

#include "bindings/bindings.hpp"
#include "bindings/seed_coding.hpp"
#include "bitstream/frequency_tables.hpp"
#include "rdoq/coordinate_descent.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::has_shape;
using sgi::require;

namespace {

// None where all are 1.
using Weights = std::optional<Array<const float, 2>>;

void require_tables(const Array<const int32_t, 1> &support, const Array<const int64_t, 1> &start,
                    const Array<const double, 1> &bits) {
  const size_t tables = support.shape(0);
  require(start.shape(0) == tables, "support and start must be [tables]");
  for (size_t t = 0; t < tables; ++t)
    require(support.data()[t] >= 0 && start.data()[t] >= 0 &&
                size_t(start.data()[t]) + 2 * size_t(support.data()[t]) + 2 <= bits.shape(0),
            "a table exceeds bits");
}

sgi::Residual residual_of(const Array<float, 3> &samples, const Weights &weights, size_t channels) {
  require(samples.shape(0) == channels && samples.shape(1) > 0 && samples.shape(2) > sgi::kWindowPadding &&
              samples.shape(1) < (1 << 30) && samples.shape(2) < (1 << 30),
          "residual must be [C, H, W + padding]");
  require(!weights || has_shape(*weights, samples.shape(1), samples.shape(2)), "weights must be [H, W + padding]");
  const int row = int(samples.shape(2)), width = row - sgi::kWindowPadding;
  return {samples.data(), int(channels), int(samples.shape(1)), width, row, weights ? weights->data() : nullptr};
}

auto search_seeds(const nb::bytes &header, Array<const int32_t, 2> corner, Array<const int8_t, 1> log_size,
                  const sgi::Plan &plan, const sgi::NetworkArrays &networks, Array<const double, 2> values,
                  Array<const int32_t, 1> support, Array<const int64_t, 1> start, Array<const double, 1> bits,
                  Array<float, 3> residual, Weights weights, float lmbda, float cutoff, int deep, int threads,
                  const std::string &isa) {
  const sgi::SeedCoding coding(header, corner, log_size, plan, networks, isa);
  const sgi::ModelSpec &spec = coding.header.spec;
  const size_t n = log_size.shape(0), d = size_t(spec.attributes()), channels = size_t(spec.channels);
  require(spec.is_plain() && channels <= size_t(sgi::kMaxColours),
          "seeds must hold their Gaussians, of 64 channels at most");
  require(has_shape(values, n, d), "values [N, C + 5]");
  require_tables(support, start, bits);
  require(support.shape(0) == size_t(sgi::kTables), "there must be a table for every scale and family");
  const sgi::SymbolBits tables{support.data(), start.data(), bits.data(), coding.model.first_table};
  const sgi::CodingModel model{coding.model, tables};
  const sgi::Residual left = residual_of(residual, weights, channels);
  std::vector<int64_t> decoded(n * d);
  std::vector<double> change(n);
  {
    const nb::gil_scoped_release release;
    sgi::search_seeds(coding.seeds, model, {lmbda, cutoff, deep}, left, values.data(), {decoded.data(), change.data()},
                      threads);
  }
  return std::tuple(sgi::as_array<int64_t>(std::move(decoded), std::array{n, d}),
                    sgi::as_array<double>(std::move(change), std::array{n}));
}

}  // namespace

void bind_rdoq(nb::module_ &m) {
  m.def("search_seeds", &search_seeds, "header"_a, "corner"_a, "log_size"_a, "plan"_a, "networks"_a, "values"_a,
        "support"_a, "start"_a, "bits"_a, "residual"_a, "weights"_a, "lmbda"_a, "cutoff"_a, "deep"_a, "threads"_a,
        "isa"_a, "Attributes [N, C + 5] in 2^-24 and the change of cost [N]; `residual` becomes what they leave.");
}
