#include <algorithm>
#include <cmath>
#include <tuple>

#include "bindings/bindings.hpp"
#include "bindings/seed_coding.hpp"
#include "bitstream/frequency_tables.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::has_shape;
using sgi::require;

namespace {

// The symbols nearest to values, but for a lean towards zero.
class Quantiser {
 public:
  // values [N, width]; leans: by scale index, of steps.
  Quantiser(const double *values, int64_t width, const double *leans, int first_table)
      : values_(values), width_(width), leans_(leans), first_table_(first_table) {}

  void code(const sgi::AttributeRun &run, int32_t *symbols) {
    const int64_t size = run.group.size();
    for (int64_t i = 0; i < run.count(); ++i) {
      const double value = values_[run.members[size_t(i / size)] * width_ + run.group.first + i % size];
      const double position = (value * (1 << sgi::kFractionBits) - double(run.mean[i])) / double(run.step[i]);
      const double size_of = std::floor(std::abs(position) + 0.5 - leans_[run.tables[i] - first_table_]);
      symbols[i] = int32_t(std::copysign(std::min(size_of, double(sgi::kMaxMagnitude)), position));
    }
    const auto count = size_t(run.count());
    runs.push_back({run.number, size_t(size), sgi::copy(symbols, count), sgi::copy(run.tables, count),
                    sgi::copy(run.step, count)});
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
                         const sgi::Plan &plan, const sgi::NetworkArrays &networks, Array<const uint8_t, 1> signs,
                         Array<const double, 2> values, Array<const double, 1> leans, int threads,
                         const std::string &isa) {
  sgi::SeedCoding coding(header, corner, log_size, plan, networks, isa);
  const sgi::ModelSpec &spec = coding.header.spec;
  const size_t count = log_size.shape(0), width = size_t(spec.attributes());
  require(has_shape(values, count, width), "values must be [N, d_A]");
  require(leans.shape(0) == size_t(sgi::kFamilySize), "leans of every scale");
  const sgi::HashGrid grid(spec.context, coding.header.width, coding.header.height);
  int64_t expected = 0;
  for (const int64_t level : grid.counts()) expected += level;
  require(int64_t(signs.shape(0)) == expected, "signs of every resolution of the hash grid");
  if (expected) coding.model.grid = &grid, coding.model.grid_signs = signs.data();
  Quantiser quantiser(values.data(), int64_t(width), leans.data(), coding.model.first_table);
  std::vector<int64_t> decoded(count * width);
  {
    const nb::gil_scoped_release release;
    const auto code = [&](const sgi::AttributeRun &run, int32_t *symbols) { quantiser.code(run, symbols); };
    sgi::code_attributes(code, coding.model, coding.seeds, threads, decoded.data());
  }
  std::vector<decltype(std::declval<Quantiser::Run>().arrays())> runs;
  for (Quantiser::Run &run : quantiser.runs) runs.push_back(std::move(run).arrays());
  return std::tuple(as_array<int64_t>(std::move(decoded), std::array{count, width}), std::move(runs));
}

auto neighbours_by_pass(int ranks, Array<const int32_t, 2> corner, Array<const int8_t, 1> log_size) {
  sgi::SeedCoding::require_seeds(corner, log_size);
  require(ranks >= 0 && ranks <= sgi::kMaxNeighbours, "there are more neighbours than weights for them");
  const std::vector<int32_t> corners = sgi::copy(corner);
  const std::vector<int8_t> sizes = sgi::copy(log_size);
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
