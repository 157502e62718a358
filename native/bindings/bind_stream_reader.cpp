#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>
#include <vector>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/chunk_kinds.hpp"
#include "bitstream/container.hpp"
#include "model/tile_grid.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

nb::list segments(int64_t length, int64_t count, int64_t apron, double start, double scale, int64_t first, int64_t n) {
  sgi::require(length >= 1 && count >= 1 && apron >= 0 && n >= 1, "length, count and n must be at least 1");
  nb::list found;
  for (sgi::TileSegment &segment : sgi::TileAxis{length, count, apron}.segments(start, scale, first, n)) {
    const size_t size = segment.weight.size();
    nb::object weight = nb::none();
    if (size) weight = nb::cast(sgi::as_array<float>(std::move(segment.weight), std::array{size}));
    found.append(nb::make_tuple(segment.first, segment.last, segment.tile, weight));
  }
  return found;
}

}  // namespace

void bind_stream_reader(nb::module_ &m) {
  nb::list kinds;
  for (const auto &[letter, name, is_once, metadata] : sgi::kChunkKinds)
    kinds.append(nb::make_tuple(nb::str(&letter, 1), name, is_once, metadata));
  m.attr("CHUNK_KINDS") = nb::tuple(kinds);
  m.attr("MAX_PAYLOAD") = sgi::kMaxPayload;
  m.attr("SIGNATURE") = nb::bytes(sgi::kSignature, sgi::kSignatureBytes);
  m.def("tile_segments", &segments, "length"_a, "count"_a, "apron"_a, "start"_a, "scale"_a, "first"_a, "n"_a,
        "First and last pixel, tile and the next one's share, or None, of each run of output pixels along an axis.");
}
