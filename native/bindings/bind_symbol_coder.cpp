#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/checks.hpp"
#include "bindings/textures.hpp"
#include "bindings/tile_models.hpp"
#include "bitstream/arrays.hpp"
#include "bitstream/frequency_tables.hpp"
#include "bitstream/positions.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::require;
using sgi::SymbolReader;
using sgi::SymbolWriter;

namespace {

using Size = std::pair<int64_t, int64_t>;

void require_size(Size size) {
  require(size.first >= 1 && size.second >= 1 && size.first <= sgi::kMaxSide && size.second <= sgi::kMaxSide,
          "sides must be 1..2**24");
}

// A coder codes what it is given, and gives back what is there then: a writer the same, a reader what it finds.
template <class Coder>
auto code_symbols(Coder &coder, const Array<const int32_t, 1> &given, const Array<const int16_t, 1> &tables) {
  std::vector<int32_t> symbols = sgi::copy(given);
  require(tables.size() == symbols.size() && symbols.size() < (size_t(1) << 31), "a table for each symbol");
  for (size_t i = 0; i < tables.size(); ++i)
    require(tables.data()[i] >= 0 && tables.data()[i] < sgi::kTables, "a table is outside 0..127");
  coder.zero_centred(tables.data(), int64_t(tables.size()), symbols.data());
  return as_array(std::move(symbols));
}

template <class Coder>
auto code_flags(Coder &coder, const Array<const int32_t, 1> &given, const Array<const int32_t, 1> &ones) {
  std::vector<int32_t> flags = sgi::copy(given);
  require(ones.size() == flags.size(), "a probability for each bit");
  for (size_t i = 0; i < flags.size(); ++i) {
    require(ones.data()[i] > 0 && ones.data()[i] < sgi::kCertain, "P(1) must be 1..65535 in 2^-16");
    coder.range().code(ones.data()[i], flags[i]);
  }
  return as_array(std::move(flags));
}

template <class Coder>
auto code_bits(Coder &coder, const Array<const uint32_t, 1> &given, int bits) {
  require(bits >= 0 && bits <= 32, "fields of 0 to 32 bits");
  std::vector<int32_t> values(given.data(), given.data() + given.size());
  coder.values(bits, values);
  return as_array(std::vector<uint32_t>(values.begin(), values.end()));
}

template <class Coder>
auto code_weights(Coder &coder, const Array<const int64_t, 1> &given) {
  std::vector<int64_t> weights = sgi::copy(given);
  sgi::code_weights(coder, weights);
  return as_array(std::move(weights));
}

template <class Coder>
auto code_signs(Coder &coder, const Array<const uint8_t, 1> &given, const std::vector<int64_t> &counts) {
  std::vector<uint8_t> signs = sgi::copy(given);
  for (const int64_t count : counts) require(count >= 0, "a level has no negative size");
  require(std::accumulate(counts.begin(), counts.end(), int64_t(0)) == int64_t(signs.size()), "a sign for each entry");
  sgi::code_signs(coder, counts, signs);
  return as_array(std::move(signs));
}

template <class Coder>
auto code_base(Coder &coder, const Array<const int64_t, 3> &given) {
  std::vector<int64_t> planes = sgi::copy(given);
  const std::array shape{given.shape(0), given.shape(1), given.shape(2)};
  sgi::code_base(coder, int(shape[0]), int64_t(shape[1]), int64_t(shape[2]), planes);
  return as_array<int64_t>(std::move(planes), shape);
}

template <class Coder>
auto code_seeds(Coder &coder, Size size, bool is_tree, const Array<const int32_t, 2> &corner,
                const Array<const int8_t, 1> &log_size, int64_t most) {
  require_size(size);
  require(sgi::has_shape(corner, log_size.shape(0), 2), "corner must be [N, 2], log_size [N]");
  sgi::Seeds seeds{sgi::copy(corner), sgi::copy(log_size)};
  (is_tree ? sgi::code_tree<Coder> : sgi::code_positions<Coder>)(coder, size.first, size.second, most, seeds);
  const size_t n = seeds.log_size.size();
  return std::tuple(as_array<int32_t>(std::move(seeds.corner), std::array{n, size_t(2)}),
                    as_array(std::move(seeds.log_size)));
}

auto read_texture(SymbolReader &reader, Size size, int channels) {
  require_size(size);
  require(channels >= 1 && channels <= sgi::kMaxChannels, "1 to 64 channels");
  std::optional<sgi::TextureIndices> indices;
  sgi::code_texture_indices(reader, size.first, size.second, channels, indices);
  if (!indices) return std::optional<decltype(sgi::texture_arrays({}, std::declval<sgi::TextureField>()))>();
  sgi::CodedTexture found = sgi::read_texture_layer(reader, std::move(*indices), size.first, size.second, channels);
  return std::optional(sgi::texture_arrays(found.indices, std::move(found.field)));
}

void write_texture(SymbolWriter &writer, Size size, int channels, const nb::object &layer) {
  require_size(size);
  std::optional<sgi::CodedTexture> texture;
  if (!layer.is_none()) texture = sgi::texture_of(layer);
  sgi::write_texture_part(writer, texture, size.first, size.second, channels);
}

template <class Coder>
nb::class_<Coder> bind_coder(nb::module_ &m, const char *name) {
  return nb::class_<Coder>(m, name)
      .def("code", &code_symbols<Coder>, "symbols"_a, "tables"_a, "Zero-centred integers [n], each with its own table.")
      .def("code_flags", &code_flags<Coder>, "flags"_a, "ones"_a,
           "Bits [n] that are 1 with probabilities of ones / 2^16; `record` says what they spell.")
      .def(
          "record",
          [](Coder &coder, const Array<const int32_t, 1> &symbols) {
            coder.record(symbols.data(), int64_t(symbols.size()));
          },
          "symbols"_a)
      .def("code_bits", &code_bits<Coder>, "values"_a, "n_bits"_a, "Equally likely integers [n] of 0 to 32 bits.")
      .def("code_weights", &code_weights<Coder>, "weights"_a, "A tensor of integers, flat.")
      .def("code_signs", &code_signs<Coder>, "signs"_a, "counts"_a, "The hash grid's, 0 or 1, level after level.")
      .def("code_base", &code_base<Coder>, "planes"_a, "Planes [C, rows, columns] of the base layer.")
      .def("code_seeds", &code_seeds<Coder>, "size"_a, "is_tree"_a, "corner"_a, "log_size"_a, "most"_a,
           "Corners [N, 2] and log2 of the sides [N] of at most so many seeds, of one pixel or in a quadtree.")
      .def_prop_ro("crc", &Coder::crc, "CRC-32 of all symbols.")
      .def_prop_ro("count", &Coder::count, "Of symbols.")
      .def_prop_ro(
          "bits", [](const Coder &coder) { return std::accumulate(coder.bits().begin(), coder.bits().end(), 0.0); },
          "Information content of all symbols.");
}

}  // namespace

void bind_symbol_coder(nb::module_ &m) {
  bind_coder<SymbolReader>(m, "SymbolReader")
      .def(
          "__init__",
          [](SymbolReader *self, const nb::bytes &payload) { new (self) SymbolReader(sgi::bytes_of(payload)); },
          "payload"_a)
      .def("read_texture", &read_texture, "size"_a, "channels"_a,
           "Steps, log_size, contrast and symbols of a tile's texture, None for none.")
      .def(
          "finish", [](SymbolReader &reader) { reader.finish(); },
          "Raises CorruptStreamError unless the symbols are those written and the payload ends with them.")
      .def_prop_ro(
          "ends", [](SymbolReader &reader) { return reader.range().maybe_exhausted(); },
          "Whether an encoder may have ended here.");
  bind_coder<SymbolWriter>(m, "SymbolWriter")
      .def(nb::init<>())
      .def("write_texture", &write_texture, "size"_a, "channels"_a, "layer"_a.none(), "TextureSymbols, None for none.")
      .def("finish", [](SymbolWriter &writer) { return sgi::as_bytes(writer.finish()); }, "The payload.");
  m.def(
      "write_mask",
      [](const Array<const uint8_t, 2> &mask) {
        require_size({int64_t(mask.shape(1)), int64_t(mask.shape(0))});
        const sgi::WrittenMask written(mask.data(), int64_t(mask.shape(1)), int64_t(mask.shape(0)));
        return std::pair(sgi::as_bytes(written.payload), written.mixed);
      },
      "mask"_a, "The payload of a mask [h, w], and its mixed squares.");
  m.def("max_mixed", &sgi::max_mixed, "payload_bytes"_a, "The mixed squares that a mask of this length may have.");
}
