#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <tuple>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/tile_models.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::has_shape;
using sgi::require;

namespace {

auto quantise(const nb::bytes &header, nb::handle model) {
  const sgi::SeedCoding coding(header, model, "auto");
  const std::vector<double> values = sgi::attributes_of(coding.header, model);
  std::vector<int64_t> decoded(values.size());
  {
    const nb::gil_scoped_release release;
    sgi::code_attributes(sgi::nearest_symbols(coding.model, values.data()), coding.model, coding.seeds, 1,
                         decoded.data());
  }
  return as_array<int64_t>(std::move(decoded),
                           std::array{coding.tile.log_size.size(), size_t(coding.model.attributes)});
}

auto neighbours_by_pass(int ranks, Array<const int32_t, 2> corner, Array<const int8_t, 1> log_size) {
  require(has_shape(corner, log_size.shape(0), 2), "corner must be [N, 2], log_size [N]");
  sgi::require_cells(log_size);
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
  m.def("quantise", &quantise, "header"_a, "model"_a, "What attributes of a TileModel decode to [N, d_A], in 2^-24.");
}
