#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>

#include <variant>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/restoration_part.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::require;

namespace {

using Tile = Array<const float, 3>;

using OneOf = std::variant<int, nb::bytes>;

// The shipped one of a number, or that of a file.
std::shared_ptr<const sgi::RestorationNetwork> network_of(const OneOf &network) {
  const auto *file = std::get_if<nb::bytes>(&network);
  if (!file) return sgi::restoration_network(std::get<int>(network), {});
  return std::make_shared<const sgi::RestorationNetwork>(sgi::parse_restoration(sgi::bytes_of(*file)));
}

sgi::Restoration restoration_of(const Tile &drawn, const OneOf &network, int step, const std::string &isa) {
  const size_t channels = drawn.shape(0), rows = drawn.shape(1), columns = drawn.shape(2), pixels = rows * columns;
  require(channels >= 1 && channels <= 64 && pixels > 0 && pixels < (size_t(1) << 31), "a tile must have pixels");
  require(step >= 0 && step < 512, "step must be 0..511");
  return {network_of(network), step, int(channels), int64_t(columns), int64_t(rows), sgi::choose_isa(isa)};
}

sgi::TileBlock whole(const Tile &drawn) { return {0, 0, int64_t(drawn.shape(2)), int64_t(drawn.shape(1))}; }

// What a whole tile gets.
auto restoration_correction(Tile drawn, const OneOf &network, int step, int threads, const std::string &isa) {
  const sgi::Restoration restoration = restoration_of(drawn, network, step, isa);
  std::vector<float> planes(drawn.size());
  {
    nb::gil_scoped_release release;
    restoration.correct({drawn.data(), whole(drawn)}, threads, {planes.data(), whole(drawn)});
  }
  return sgi::as_array<float>(std::move(planes),
                              std::array{size_t(drawn.shape(0)), size_t(drawn.shape(1)), size_t(drawn.shape(2))});
}

}  // namespace

void bind_restoration(nb::module_ &m) {
  m.def("restoration_correction", &restoration_correction, "drawn"_a, "network"_a, "step"_a, "threads"_a, "isa"_a,
        "What restoration adds to a tile drawn as [C, H, W], by a shipped network or the file of another. Raises "
        "UnsupportedStreamError for an unknown network.");
  m.attr("OWN_NETWORK") = sgi::kOwnNetwork;
}
