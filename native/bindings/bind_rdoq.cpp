#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <optional>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "rdoq/base_search.hpp"
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

// Holds what a CodingModel points to.
class SymbolSearch {
 public:
  SymbolSearch(Array<const int32_t, 1> support, Array<const int64_t, 1> start, Array<const double, 1> bits, int first,
               Array<const float, 2> opponent, int threads, const std::string &isa)
      : support_(support), start_(start), bits_(bits), opponent_(opponent), threads_(threads),
        isa_(sgi::choose_isa(isa)) {
    const size_t channels = opponent.shape(0), tables = support.shape(0);
    require(opponent.shape(1) == channels && channels >= 1 && channels <= sgi::kMaxColours,
            "opponent must be [C, C], C at most 64");
    require(first >= 0 && size_t(first) + sgi::kScaleCount <= tables, "there must be a table for every scale");
    require_tables(support, start, bits);
    model_.channels = int(channels);
    model_.tables = {support_.data(), start_.data(), bits_.data(), first};
    model_.opponent = opponent_.data();
  }

  void set_group(int group, Array<const int64_t, 2> w1, Array<const int64_t, 1> b1, Array<const int64_t, 2> w2,
                 Array<const int64_t, 1> b2, int shift, int predicted, Array<const int64_t, 2> base,
                 Array<const int64_t, 1> columns, int64_t gamma) {
    require(group >= 0 && group < sgi::kGroups, "there are three groups");
    const sgi::NetworkWeights weights = sgi::network_weights(w1, b1, w2, b2, shift, predicted);
    const size_t size = group == sgi::kColour ? size_t(model_.channels) : group == sgi::kShape ? 3 : 2;
    require(predicted > 0 && weights.outputs == 2 * predicted + 1 && columns.shape(0) == size,
            "there must be a mean, a scale and a column for each attribute, and one refinement");
    sgi::require_plan(base, columns, gamma, size_t(predicted));
    networks_[group] = std::make_unique<sgi::Network>(weights, isa_);
    base_[group] = base;
    columns_[group] = columns;
    model_.networks[group] = networks_[group].get();
    model_.plans[group] = {base_[group].data(), columns_[group].data(), nullptr, gamma, int(size)};
    model_.inputs[group] = int(w1.shape(1));
  }

  void search(Array<float, 3> residual, Weights weights, Array<const int16_t, 2> inputs, Array<const double, 2> values,
              Array<const float, 2> centre, Array<const float, 1> cell, Array<const int8_t, 1> log_size,
              Array<int64_t, 2> decoded, Array<int32_t, 2> symbols, Array<int16_t, 2> scale, Array<double, 1> change,
              float lmbda, float cutoff, int deep, int rounds) {
    for (const auto &network : networks_) require(network != nullptr, "set_group comes first, for all groups");
    for (int group = 0; group < sgi::kGroups; ++group)
      require(model_.inputs[group] == model_.inputs[0] + sgi::own_input_count(group),
              "the networks must see 0, 7 and 12 inputs of a seed's own");
    const size_t n = cell.shape(0), d = size_t(model_.attributes());
    const sgi::Residual r = residual_of(residual, weights, size_t(model_.channels));
    require(inputs.shape(0) == n && int(inputs.shape(1)) >= model_.inputs[0] && has_shape(centre, n, 2) &&
                log_size.shape(0) == n,
            "inputs [n, I], centre [n, 2], cell [n], log_size [n]");
    require(has_shape(values, n, d) && has_shape(decoded, n, d) && has_shape(symbols, n, d) && has_shape(scale, n, d) &&
                change.shape(0) == n,
            "values, decoded, symbols and scale [n, C + 5], change [n]");
    const sgi::SeedArrays seeds{int64_t(n),    inputs.data(), int64_t(inputs.shape(1)), values.data(),
                                centre.data(), cell.data(),   log_size.data()};
    const sgi::SymbolArrays out{decoded.data(), symbols.data(), scale.data(), change.data()};
    nb::gil_scoped_release release;
    sgi::search_seeds(model_, {lmbda, cutoff, deep, rounds}, r, seeds, out, threads_, isa_);
  }

 private:
  Array<const int32_t, 1> support_;
  Array<const int64_t, 1> start_;
  Array<const double, 1> bits_;
  Array<const float, 2> opponent_;
  Array<const int64_t, 2> base_[sgi::kGroups];
  Array<const int64_t, 1> columns_[sgi::kGroups];
  std::unique_ptr<sgi::Network> networks_[sgi::kGroups];
  sgi::CodingModel model_{};
  int threads_;
  sgi::Isa isa_;
};

void prune_gaussians(Array<float, 3> residual, Weights weights, Array<const float, 2> means,
                     Array<const float, 2> covariances, Array<const float, 2> colours, Array<const float, 1> price,
                     float cutoff, int threads, const std::string &isa, Array<bool, 1> pruned) {
  const size_t n = means.shape(0), channels = colours.shape(1);
  const sgi::Residual r = residual_of(residual, weights, channels);
  require(means.shape(1) == 2 && has_shape(covariances, n, 3) && colours.shape(0) == n && price.shape(0) == n &&
              pruned.shape(0) == n,
          "means [n, 2], covariances [n, 3], colours [n, C], price [n], pruned [n]");
  const sgi::Prunable gaussians{means.data(), covariances.data(), colours.data(), price.data(), int64_t(n)};
  nb::gil_scoped_release release;
  sgi::prune_gaussians(r, gaussians, cutoff, threads, sgi::choose_isa(isa), pruned.data());
}

int64_t search_base(Array<int64_t, 3> planes, Array<const int32_t, 1> predictor, Array<const int32_t, 2> weights,
                    Array<const int32_t, 1> table, Array<const int32_t, 1> support, Array<const int64_t, 1> start,
                    Array<const double, 1> bits, Array<const double, 2> down, Array<const double, 2> across,
                    std::optional<Array<const double, 4>> gram, Array<double, 3> pull, double step, double lmbda,
                    int passes) {
  const size_t channels = planes.shape(0), rows = planes.shape(1), columns = planes.shape(2);
  require(predictor.shape(0) == channels && has_shape(weights, channels, channels) && table.shape(0) == channels,
          "predictor [C], weights [C, C], table [C]");
  require(has_shape(down, rows, rows) && has_shape(across, columns, columns) && pull.shape(0) == channels &&
              pull.shape(1) == rows && pull.shape(2) == columns,
          "down [rows, rows], across [columns, columns], pull [C, rows, columns]");
  constexpr size_t kSpan = 2 * sgi::kBaseReach + 1;
  require(!gram || (has_shape(*gram, rows, columns) && gram->shape(2) == kSpan && gram->shape(3) == kSpan),
          "gram must be [rows, columns, 7, 7]");
  require_tables(support, start, bits);
  for (size_t c = 0; c < channels; ++c)
    require(table.data()[c] >= 0 && size_t(table.data()[c]) < support.shape(0), "a table does not exist");
  const sgi::SymbolBits tables{support.data(), start.data(), bits.data(), 0};
  const sgi::BasePlanes base{planes.data(),    int64_t(channels), int64_t(rows), int64_t(columns),
                             predictor.data(), weights.data(),    table.data(),  tables};
  nb::gil_scoped_release release;
  return sgi::search_base(base, {down.data(), across.data(), gram ? gram->data() : nullptr, pull.data(), step}, lmbda,
                          passes);
}

}  // namespace

void bind_rdoq(nb::module_ &m) {
  nb::class_<SymbolSearch>(m, "SymbolSearch")
      .def(nb::init<Array<const int32_t, 1>, Array<const int64_t, 1>, Array<const double, 1>, int,
                    Array<const float, 2>, int, const std::string &>(),
           "support"_a, "start"_a, "bits"_a, "first"_a, "opponent"_a, "threads"_a, "isa"_a)
      .def("set_group", &SymbolSearch::set_group, "group"_a, "w1"_a, "b1"_a, "w2"_a, "b2"_a, "shift"_a, "predicted"_a,
           "base"_a, "columns"_a, "gamma"_a)
      .def("search", &SymbolSearch::search, "residual"_a, "weights"_a, "inputs"_a, "values"_a, "centre"_a, "cell"_a,
           "log_size"_a, "decoded"_a, "symbols"_a, "scale"_a, "change"_a, "lmbda"_a, "cutoff"_a, "deep"_a, "rounds"_a);
  m.def("prune_gaussians", &prune_gaussians, "residual"_a, "weights"_a, "means"_a, "covariances"_a, "colours"_a,
        "price"_a, "cutoff"_a, "threads"_a, "isa"_a, "pruned"_a);
  m.def("search_base", &search_base, "planes"_a, "predictor"_a, "weights"_a, "table"_a, "support"_a, "start"_a,
        "bits"_a, "down"_a, "across"_a, "gram"_a, "pull"_a, "step"_a, "lmbda"_a, "passes"_a);
}
