#include <nanobind/stl/string.h>

#include <array>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/textures.hpp"
#include "bitstream/arrays.hpp"
#include "bitstream/frequency_tables.hpp"
#include "bitstream/header.hpp"
#include "bitstream/mask.hpp"
#include "bitstream/positions.hpp"
#include "bitstream/symbol_reader.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::as_array;
using sgi::require;
using sgi::SymbolReader;

namespace {

void make_reader(SymbolReader *self, const nb::bytes &payload) { new (self) SymbolReader(sgi::bytes_of(payload)); }

void require_keys(const Array<const int16_t, 1> &keys, int64_t count) {
  require(keys.size() < (size_t(1) << 31), "too many symbols");
  for (size_t i = 0; i < keys.size(); ++i)
    require(keys.data()[i] >= 0 && keys.data()[i] < count, "a table or row is outside 0..count-1");
}

auto read_symbols(SymbolReader &reader, const Array<const int16_t, 1> &tables) {
  require_keys(tables, sgi::kTables);
  std::vector<int32_t> symbols(tables.size());
  reader.zero_centred(tables.data(), int64_t(tables.size()), symbols.data());
  return as_array(std::move(symbols));
}

auto read_flags(SymbolReader &reader, const Array<const int32_t, 1> &ones) {
  std::vector<int32_t> flags(ones.size());
  for (size_t i = 0; i < flags.size(); ++i) {
    require(ones.data()[i] > 0 && ones.data()[i] < sgi::kCertain, "P(1) must be 1..65535 in 2^-16");
    flags[i] = reader.decoder().decode_bit(uint32_t(ones.data()[i]));
  }
  reader.record(flags.data(), int64_t(flags.size()));
  return as_array(std::move(flags));
}

auto read_bits(SymbolReader &reader, int bits, int64_t count) {
  require(bits >= 0 && bits <= 32 && count >= 0, "fields of 0 to 32 bits");
  const std::vector<int32_t> found = reader.values(bits, count);
  return as_array(std::vector<uint32_t>(found.begin(), found.end()));
}

auto read_weights(SymbolReader &reader, int64_t count) {
  require(count >= 0, "a tensor has no negative size");
  return as_array(sgi::read_weights(reader, count));
}

auto read_signs(SymbolReader &reader, const std::vector<int64_t> &counts) {
  for (const int64_t count : counts) require(count >= 0, "a level has no negative size");
  return as_array(sgi::read_signs(reader, counts));
}

auto read_base(SymbolReader &reader, int channels, int64_t rows, int64_t columns) {
  require(channels >= 1 && rows >= 1 && columns >= 1, "planes must not be empty");
  const std::array shape{size_t(channels), size_t(rows), size_t(columns)};
  return as_array<int64_t>(sgi::read_base(reader, channels, rows, columns), shape);
}

using Size = std::pair<int64_t, int64_t>;

void require_size(Size size) {
  require(size.first >= 1 && size.second >= 1 && size.first <= sgi::kMaxSide && size.second <= sgi::kMaxSide,
          "sides must be 1..2**24");
}

auto arrays_of(sgi::Seeds seeds) {
  const size_t n = seeds.log_size.size();
  return std::tuple(as_array<int32_t>(std::move(seeds.corner), std::array{n, size_t(2)}),
                    as_array(std::move(seeds.log_size)));
}

auto read_positions(SymbolReader &reader, Size size, int64_t most) {
  require_size(size);
  return arrays_of(sgi::read_positions(reader, size.first, size.second, most));
}

auto read_tree(SymbolReader &reader, Size size, int64_t most) {
  require_size(size);
  return arrays_of(sgi::read_tree(reader, size.first, size.second, most));
}

// Bits as they are coded, their P(1) in 2^-16, and their information content.
auto arrays_of(sgi::BitRecorder written) {
  const double content = written.account.total();
  return std::tuple(as_array(std::move(written.bits)), as_array(std::move(written.ones)), content);
}

auto write_tree(Size size, const Array<const int32_t, 2> &corner, const Array<const int8_t, 1> &log_size) {
  require_size(size);
  require(sgi::has_shape(corner, log_size.shape(0), 2), "corner must be [N, 2], log_size [N]");
  const sgi::Seeds seeds{{corner.data(), corner.data() + corner.size()},
                         {log_size.data(), log_size.data() + log_size.size()}};
  return arrays_of(sgi::write_tree(size.first, size.second, seeds));
}

auto write_signs(const Array<const int32_t, 1> &signs, const std::vector<int64_t> &counts) {
  require(std::accumulate(counts.begin(), counts.end(), int64_t(0)) == int64_t(signs.size()), "a sign for each entry");
  for (const int64_t count : counts) require(count >= 0, "a level has no negative size");
  return arrays_of(sgi::write_signs({signs.data(), signs.data() + signs.size()}, counts));
}

auto write_mask(const Array<const uint8_t, 2> &mask) {
  require_size({int64_t(mask.shape(1)), int64_t(mask.shape(0))});
  sgi::WrittenMask written(mask.data(), int64_t(mask.shape(1)), int64_t(mask.shape(0)));
  return std::tuple_cat(arrays_of(std::move(written.bits)), std::tuple(written.mixed));
}

auto read_texture(SymbolReader &reader, Size size, int channels) {
  require_size(size);
  require(channels >= 1 && channels <= sgi::kMaxChannels, "1 to 64 channels");
  std::optional<sgi::CodedTexture> texture;
  if (auto indices = sgi::read_texture_indices(reader, size.first, size.second, channels))
    texture = sgi::read_texture_layer(reader, std::move(*indices), size.first, size.second, channels);
  return texture ? std::optional(sgi::texture_arrays(texture->indices, std::move(texture->field))) : std::nullopt;
}

double bits_of(const SymbolReader &reader) { return std::accumulate(reader.bits().begin(), reader.bits().end(), 0.0); }

}  // namespace

void bind_symbol_reader(nb::module_ &m) {
  nb::class_<SymbolReader>(m, "SymbolReader", "Reads a payload group by group, part by part: the decoder's own reader.")
      .def("__init__", &make_reader, "payload"_a)
      .def("read", &read_symbols, "tables"_a, "Zero-centred integers [n], each with its own table.")
      .def("read_flags", &read_flags, "ones"_a, "Bits [n] that are 1 with probabilities of ones / 2^16.")
      .def("read_bits", &read_bits, "n_bits"_a, "count"_a, "Equally likely integers [count] of 0 to 32 bits.")
      .def("read_weights", &read_weights, "count"_a, "A tensor of so many integers, flat.")
      .def("read_signs", &read_signs, "counts"_a, "The hash grid's signs, 0 or 1, level after level.")
      .def("read_base", &read_base, "channels"_a, "rows"_a, "columns"_a, "Planes [C, rows, columns] of the base layer.")
      .def("read_positions", &read_positions, "size"_a, "most"_a,
           "Corners [N, 2] and log2 of the sides [N] of at most so many seeds of one pixel.")
      .def("read_tree", &read_tree, "size"_a, "most"_a, "The same of a quadtree.")
      .def("read_texture", &read_texture, "size"_a, "channels"_a,
           "Steps, log_size, contrast and symbols of a tile's texture, None for none.")
      .def(
          "finish", [](SymbolReader &reader) { reader.finish(); },
          "Raises CorruptStreamError unless the symbols are those written and the payload ends with them.")
      .def_prop_ro("crc", &SymbolReader::crc, "CRC-32 of all symbols.")
      .def_prop_ro("count", &SymbolReader::count, "Of symbols.")
      .def_prop_ro(
          "ends", [](SymbolReader &reader) { return reader.decoder().maybe_exhausted(); },
          "Whether an encoder may have ended here.")
      .def_prop_ro("bits", &bits_of, "Information content of all symbols.");
  m.def("write_mask", &write_mask, "mask"_a,
        "The bits of a mask [h, w] as they are coded, their P(1) in 2^-16, information content, mixed squares.");
  m.def("max_mixed", &sgi::max_mixed, "payload_bytes"_a, "The mixed squares that a mask of this length may have.");
  m.def("write_signs", &write_signs, "signs"_a, "counts"_a,
        "Values 0 or 1, level after level, as they are coded, their P(1) in 2^-16, information content.");
  m.def("write_tree", &write_tree, "size"_a, "corner"_a, "log_size"_a,
        "The flags of the tree of these seeds as they are coded, their P(1) in 2^-16, information content.");
}
