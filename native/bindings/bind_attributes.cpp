#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "bitstream/context_model.hpp"
#include "bitstream/frequency_tables.hpp"
#include "bitstream/header.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::has_shape;
using sgi::require;

namespace {

using Weights = Array<const int64_t, 2>;
using Biases = Array<const int64_t, 1>;
using Plan = std::vector<std::tuple<Weights, int>>;
using NetworkArrays = std::vector<std::tuple<Weights, Biases, Weights, Biases, int>>;

template <class T>
std::vector<T> copy(const T *from, size_t count) {
  return {from, from + count};
}

template <class A>
auto copy(const A &array) {
  return copy(array.data(), array.size());
}

std::vector<sgi::GroupSteps> plan_of(const sgi::ModelSpec &spec, const Plan &given) {
  const std::vector<sgi::SeedGroup> groups = spec.groups();
  require(given.size() == groups.size(), "a plan has the steps of every group");
  std::vector<sgi::GroupSteps> plan;
  for (const auto &[base, gamma] : given) {
    const auto units = size_t(sgi::output_count(spec, groups[plan.size()]));
    require(has_shape(base, units, sgi::kLevels) && gamma >= 0 && gamma < 64, "base must be [U, 8], gamma 0..63");
    for (size_t i = 0; i < base.size(); ++i)
      require(base.data()[i] >= 0 && base.data()[i] < sgi::kStepCount, "a base step is outside the table of steps");
    plan.push_back({copy(base), gamma});
  }
  return plan;
}

sgi::Networks networks_of(const sgi::ModelSpec &spec, const NetworkArrays &given) {
  const auto steps = sgi::coding_steps(spec);
  require(given.size() == steps.size(), "there is a network for every coding step");
  sgi::Networks networks;
  for (const auto &[w1, b1, w2, b2, shift] : given) {
    const size_t step = networks.size();
    const int inputs = sgi::input_count(spec, int(step)), outputs = sgi::network_outputs(spec, steps[step]);
    const int hidden = spec.context.hidden, predicted = (outputs - int(steps[step].size())) / 2;
    require(has_shape(w1, size_t(hidden), size_t(inputs)) && b1.shape(0) == size_t(hidden) &&
                has_shape(w2, size_t(outputs), size_t(hidden)) && b2.shape(0) == size_t(outputs),
            "a network has the weights of its coding step");
    networks.push_back(std::make_shared<const sgi::IntNetwork>(
        sgi::IntNetwork{copy(w1), copy(b1), copy(w2), copy(b2), inputs, hidden, outputs, predicted, shift}));
    networks.back()->require_exact();
  }
  return networks;
}

// The symbols nearest to values, but for a lean towards zero.
class Quantiser : public sgi::AttributeSymbols {
 public:
  // values [N, width]; leans: by scale index, of steps.
  Quantiser(const double *values, int64_t width, const double *leans, int first_table)
      : values_(values), width_(width), leans_(leans), first_table_(first_table) {}

  sgi::Reading code(const sgi::AttributeRun &run, int32_t *symbols) override {
    const int64_t size = run.group.size();
    for (int64_t i = 0; i < run.count(); ++i) {
      const double value = values_[run.members[size_t(i / size)] * width_ + run.group.first + i % size];
      const double position = (value * (1 << sgi::kFractionBits) - double(run.mean[i])) / double(run.step[i]);
      const double size_of = std::floor(std::abs(position) + 0.5 - leans_[run.tables[i] - first_table_]);
      symbols[i] = int32_t(std::copysign(std::min(size_of, double(sgi::kMaxMagnitude)), position));
    }
    const auto count = size_t(run.count());
    runs.push_back({run.number, size_t(size), copy(symbols, count), copy(run.tables, count), copy(run.step, count)});
    return sgi::Reading::kSound;
  }

  struct Run {
    size_t number, size;
    std::vector<int32_t> symbols;
    std::vector<int16_t> tables;
    std::vector<int64_t> steps;

    auto arrays() && {
      const std::array shape{symbols.size() / size, size};
      return std::tuple(number, as_array<int32_t>(std::move(symbols), shape),
                        as_array<int16_t>(std::move(tables), shape), as_array<int64_t>(std::move(steps), shape));
    }
  };
  std::vector<Run> runs;

 private:
  const double *values_;
  int64_t width_;
  const double *leans_;
  int first_table_;
};

auto quantise_attributes(const nb::bytes &header, Array<const int32_t, 2> corner, Array<const int8_t, 1> log_size,
                         const Plan &plan, const NetworkArrays &networks, Array<const uint8_t, 1> signs,
                         Array<const double, 2> values, Array<const double, 1> leans, int threads,
                         const std::string &isa) {
  const sgi::Header own = sgi::decode_header({static_cast<const uint8_t *>(header.data()), header.size()});
  const sgi::ModelSpec &spec = own.spec;
  const size_t count = log_size.shape(0), width = size_t(spec.attributes());
  require(has_shape(corner, count, 2) && has_shape(values, count, width), "corner [N, 2], values [N, d_A]");
  require(leans.shape(0) == size_t(sgi::kFamilySize), "leans of every scale");
  sgi::require_cells(log_size);
  const sgi::HashGrid grid(spec.context, own.width, own.height);
  int64_t expected = 0;
  for (const int64_t level : grid.counts()) expected += level;
  require(int64_t(signs.shape(0)) == expected, "signs of every resolution of the hash grid");
  sgi::AttributeModel model = sgi::attribute_model(spec, plan_of(spec, plan), networks_of(spec, networks), own.quality,
                                                   own.family, sgi::choose_isa(isa));
  if (expected) model.grid = &grid, model.grid_signs = signs.data();
  const std::vector<int32_t> corners = copy(corner);
  const std::vector<int8_t> sizes = copy(log_size);
  Quantiser quantiser(values.data(), int64_t(width), leans.data(), model.first_table);
  std::vector<int64_t> decoded(count * width);
  {
    const nb::gil_scoped_release release;
    const sgi::TileSeeds seeds(spec.context, corners, sizes);
    std::vector<int32_t> symbols;
    sgi::code_attributes(quantiser, model, seeds, threads, decoded.data(), symbols);
  }
  std::vector<decltype(std::declval<Quantiser::Run>().arrays())> runs;
  for (Quantiser::Run &run : quantiser.runs) runs.push_back(std::move(run).arrays());
  return std::tuple(as_array<int64_t>(std::move(decoded), std::array{count, width}), std::move(runs));
}

auto neighbours_by_pass(int ranks, Array<const int32_t, 2> corner, Array<const int8_t, 1> log_size) {
  require(has_shape(corner, log_size.shape(0), 2), "corner must be [N, 2], log_size [N]");
  require(ranks >= 0 && ranks <= sgi::kMaxNeighbours, "there are more neighbours than weights for them");
  sgi::require_cells(log_size);
  const std::vector<int32_t> corners = copy(corner);
  const std::vector<int8_t> sizes = copy(log_size);
  sgi::ContextSpec context;
  context.neighbours = ranks;
  sgi::TileSeeds seeds(context, corners, sizes);
  std::vector<std::vector<int32_t>> tables;
  {
    const nb::gil_scoped_release release;
    tables = sgi::neighbours_by_pass(seeds, ranks, sgi::choose_isa("auto"));
  }
  const auto arrays = [&](size_t pass) {
    const std::array shape{seeds.passes[pass].size()};
    return std::tuple(as_array<int64_t>(std::move(seeds.passes[pass]), shape),
                      as_array<int32_t>(std::move(tables[pass]), std::array{shape[0], size_t(ranks)}));
  };
  std::vector<decltype(arrays(0))> found;
  for (size_t pass = 0; pass < tables.size(); ++pass) found.push_back(arrays(pass));
  return found;
}

}  // namespace

void bind_attributes(nb::module_ &m) {
  m.def("neighbours_by_pass", &neighbours_by_pass, "ranks"_a, "corner"_a, "log_size"_a,
        "The seeds of each pass [n], and their nearest seeds of earlier passes [n, ranks]: nearest first, -1 where "
        "there\n"
        "is none.");
  m.def("quantise_attributes", &quantise_attributes, "header"_a, "corner"_a, "log_size"_a, "plan"_a, "networks"_a,
        "signs"_a, "values"_a, "leans"_a, "threads"_a, "isa"_a,
        "What values [N, d_A] decode to, in 2^-24, and in coding order numbers of groups, symbols, tables and steps.");
}
