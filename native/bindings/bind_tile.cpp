#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <array>
#include <memory>
#include <tuple>
#include <vector>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bindings/textures.hpp"
#include "bindings/tile_models.hpp"
#include "bitstream/limits.hpp"
#include "bitstream/shipped_networks.hpp"
#include "bitstream/tile.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using sgi::Array;
using sgi::bytes_of;
using sgi::kGroupNames;
using sgi::require;

namespace {

constexpr const char *kPartNames[sgi::kParts] = {"steps",         "base",        "positions", "decoders", "hash grid",
                                                 "context model", "colour",      "shape",     "feature",  "scales",
                                                 "offset",        "restoration", "texture",   "check"};

// A tile's model and what it was read with, which tells the shapes of its arrays.
struct ReadTile {
  sgi::Header header;
  sgi::TileModel model;
};

template <class T>
using Numbers = nb::ndarray<nb::numpy, T>;

// A view of numbers that `owner` holds.
template <class T>
Numbers<T> view(nb::handle owner, std::vector<T> &values, std::initializer_list<size_t> shape) {
  return Numbers<T>(values.data(), shape, owner);
}
template <class T>
Numbers<T> copy(const std::vector<T> &values, std::initializer_list<size_t> shape) {
  auto *owned = new std::vector<T>(values);
  nb::capsule owner(owned, [](void *held) noexcept { delete static_cast<std::vector<T> *>(held); });
  return Numbers<T>(owned->data(), shape, owner);
}

ReadTile read_tile(const nb::bytes &header, const nb::bytes &payload, int threads, const std::string &isa,
                   bool checked) {
  const sgi::Isa chosen = sgi::choose_isa(isa);
  const sgi::Bytes fields = bytes_of(header), symbols = bytes_of(payload);
  nb::gil_scoped_release release;
  const sgi::Header own = sgi::decode_header(fields);
  return {own, sgi::read_tile(own, symbols, {threads, chosen, checked})};
}

ReadTile &tile_of(nb::handle self) { return nb::cast<ReadTile &>(self); }

auto base_of(nb::handle self) {
  ReadTile &tile = tile_of(self);
  const auto cell = size_t(tile.header.spec.base_cell), channels = size_t(tile.header.spec.channels);
  const size_t rows = cell ? (size_t(tile.header.height) + cell - 1) / cell : 0;
  const size_t columns = cell ? (size_t(tile.header.width) + cell - 1) / cell : 0;
  return view(self, tile.model.base, {channels, rows, columns});
}

using Tensors = nb::typed<nb::dict, nb::str, Numbers<int64_t>>;

Tensors decoders_of(const ReadTile &tile) {
  const auto hidden = size_t(tile.header.spec.hidden), features = size_t(tile.header.spec.features);
  nb::dict decoders;
  for (const auto &[name, decoder] :
       {std::pair("colour", &tile.model.colours), std::pair("shape", &tile.model.shapes)}) {
    if (!hidden) break;
    const size_t outputs = decoder->b2.size();
    decoders[nb::str("{}.w1").format(name)] = copy(decoder->w1, {hidden, features});
    decoders[nb::str("{}.b1").format(name)] = copy(decoder->b1, {hidden});
    decoders[nb::str("{}.w2").format(name)] = copy(decoder->w2, {outputs, hidden});
    decoders[nb::str("{}.b2").format(name)] = copy(decoder->b2, {outputs});
  }
  return nb::borrow<Tensors>(decoders);
}

// By group in coding order: name, base steps [U, 8], exponent of the amplitude.
auto plan_of(const ReadTile &tile) {
  std::vector<std::tuple<std::string, Numbers<int64_t>, int>> plan;
  for (const sgi::SeedGroup &group : tile.header.spec.groups()) {
    const sgi::GroupSteps &steps = tile.model.coding.plan[plan.size()];
    plan.emplace_back(kGroupNames[size_t(group.name)],
                      copy(steps.base, {steps.base.size() / sgi::kLevels, sgi::kLevels}), steps.gamma);
  }
  return plan;
}

auto arrays_of(const sgi::Networks &given) {
  using Weights = Numbers<int64_t>;
  std::vector<std::tuple<Weights, Weights, Weights, Weights, int, int>> networks;
  for (const auto &net : given) {
    const auto inputs = size_t(net->inputs), hidden = size_t(net->hidden), outputs = size_t(net->outputs);
    networks.emplace_back(copy(net->w1, {hidden, inputs}), copy(net->b1, {hidden}), copy(net->w2, {outputs, hidden}),
                          copy(net->b2, {outputs}), net->shift, net->predicted);
  }
  return networks;
}

auto networks_of(const ReadTile &tile) { return arrays_of(tile.model.coding.networks); }

auto load_prior(const nb::bytes &header) {
  return arrays_of(sgi::load_prior(sgi::decode_header(bytes_of(header)).spec));
}

auto texture_of(const ReadTile &tile) {
  const auto &texture = tile.model.coding.texture;
  return texture ? std::optional(sgi::texture_arrays(texture->indices, texture->field)) : std::nullopt;
}

auto restoration_of(const ReadTile &tile) {
  const sgi::RestorationChoice &choice = tile.model.restoration;
  return choice.network ? std::optional(std::pair(choice.network, choice.step)) : std::nullopt;
}

using Bits = nb::typed<nb::dict, nb::str, double>;

Bits bits_of(const sgi::TileModel &model) {
  nb::dict bits;
  for (size_t part = 0; part < sgi::kParts; ++part)
    if (model.end.bits[part] > 0) bits[kPartNames[part]] = model.end.bits[part];
  return nb::borrow<Bits>(bits);
}

auto write_tile(const nb::bytes &fields, nb::handle given) {
  const sgi::Header header = sgi::decode_header(bytes_of(fields));
  sgi::TileModel model = sgi::tile_model_of(header, given);
  const std::vector<double> values = sgi::attributes_of(header, given);
  std::vector<uint8_t> payload;
  {
    const nb::gil_scoped_release release;
    payload = sgi::write_tile(header, model, values.data(), {1, sgi::choose_isa("auto")});
  }
  return std::pair(sgi::as_bytes(payload), bits_of(model));
}

using Pixels = Array<const int64_t, 1>;

auto mask_at(const sgi::Mask &mask, const Pixels &rows, const Pixels &columns) {
  for (const Pixels &pixels : {rows, columns})
    for (size_t i = 1; i < pixels.size(); ++i)
      require(pixels.data()[i - 1] <= pixels.data()[i], "rows and columns must not fall");
  const std::array shape{rows.size(), columns.size()};
  std::vector<uint8_t> out(shape[0] * shape[1]);
  mask.sample(columns.data(), int64_t(shape[1]), rows.data(), int64_t(shape[0]), out.data());
  return sgi::as_array<uint8_t, bool>(std::move(out), shape);
}

// Number of the tile, whether no pixel holds anything, masks of bands, exact samples, the payload of its model.
auto decode_tile_chunk(const nb::bytes &header, const nb::bytes &payload) {
  const sgi::TileChunk chunk = sgi::decode_tile_chunk(sgi::decode_header(bytes_of(header)), bytes_of(payload));
  std::vector<std::tuple<bool, std::shared_ptr<sgi::Mask>>> masks;
  for (const sgi::BandMask &mask : chunk.masks) masks.emplace_back(mask.is_all, mask.pixels);
  std::vector<std::tuple<int64_t, double>> exact;
  for (const sgi::ExactSample &sample : chunk.exact) exact.emplace_back(sample.place, sample.value);
  return std::tuple(chunk.number, chunk.is_empty, masks, exact, nb::bytes(chunk.model.data, chunk.model.size));
}

void bind_tile_model(nb::module_ &m) {
  const auto arrays = nb::rv_policy::reference;
  nb::class_<ReadTile>(m, "TileModel", "A tile's model as it was read; arrays are views of it.")
      .def_prop_ro(
          "corner",
          [](nb::handle self) {
            return view(self, tile_of(self).model.corner, {size_t(tile_of(self).model.seeds()), 2});
          },
          arrays, "[N, 2] pixels")
      .def_prop_ro(
          "log_size",
          [](nb::handle self) {
            return view(self, tile_of(self).model.log_size, {size_t(tile_of(self).model.seeds())});
          },
          arrays, "[N]")
      .def_prop_ro(
          "decoded",
          [](nb::handle self) {
            ReadTile &tile = tile_of(self);
            return view(self, tile.model.decoded, {size_t(tile.model.seeds()), size_t(tile.header.spec.attributes())});
          },
          arrays, "[N, d_A] attributes in units of 2^-24")
      .def_prop_ro("base", &base_of, arrays, "[C, rows, columns] in steps of index `base_step`")
      .def_prop_ro("base_step", [](const ReadTile &tile) { return tile.model.base_step; })
      .def_prop_ro("decoders", &decoders_of, nb::rv_policy::move, "Weights in units of 2^-decoder_shift, by name.")
      .def_prop_ro(
          "decoder_shift", [](const ReadTile &tile) { return tile.model.colours.shift; },
          "Of the decoders' weights; 0 where there are none.")
      .def_prop_ro("plan", &plan_of, nb::rv_policy::move,
                   "By group its name, base steps [U, 8] and the exponent of the amplitude.")
      .def_prop_ro("networks", &networks_of, nb::rv_policy::move,
                   "By coding step W1, b1, W2, b2, shift and the number of predictions.")
      .def_prop_ro(
          "signs",
          [](nb::handle self) {
            std::vector<uint8_t> &signs = tile_of(self).model.coding.signs;
            return view(self, signs, {signs.size()});
          },
          arrays, "Those of the hash grid, 0 or 1, level after level.")
      .def_prop_ro("texture", &texture_of, nb::rv_policy::move,
                   "Steps, log_size, contrast and symbols of the layer; None for none.")
      .def_prop_ro("restoration", &restoration_of, nb::rv_policy::move,
                   "Numbers of network and step, and by layer what is added to it; None for none.")
      .def_prop_ro(
          "bits", [](const ReadTile &tile) { return bits_of(tile.model); },
          "Information content of the parts, by name.")
      .def_prop_ro(
          "crc", [](const ReadTile &tile) { return tile.model.end.symbol_crc; },
          "CRC-32 of all symbols: equal on every machine.");
}

void bind_limits(nb::module_ &m) {
  m.def(
      "check_model",
      [](const nb::bytes &header) {
        const sgi::Header own = sgi::decode_header(bytes_of(header));
        sgi::check_model(own.spec, own.width, own.height);
      },
      "header"_a, "Raises LimitError for a tile of this header that would be refused whatever it holds.");
  m.def(
      "check_texture",
      [](int channels, int64_t width, int64_t height) {
        require(channels >= 1 && channels <= sgi::kMaxChannels && width >= 1 && height >= 1 && width <= sgi::kMaxSide &&
                    height <= sgi::kMaxSide,
                "1 to 64 channels, sides 1..2**24");
        sgi::check_texture(channels, width, height);
      },
      "channels"_a, "width"_a, "height"_a, "Raises LimitError for a tile that is too large to have texture.");
}

}  // namespace

void bind_tile(nb::module_ &m) {
  bind_tile_model(m), bind_limits(m);
  m.def("read_tile", &read_tile, "header"_a, "payload"_a, "threads"_a, "isa"_a, "checked"_a = true,
        "The model of a payload; `header` is the payload of chunk H that the tile would have as a picture of its own.\n"
        "Without `checked` the checksum of symbols is not compared.");
  m.def("write_tile", &write_tile, "header"_a, "model"_a,
        "The payload of a TileModel, and the information content of its parts, by name.");
  m.attr("PRIOR") = sgi::kPrior;
  m.def("load_prior", &load_prior, "header"_a, nb::rv_policy::move,
        "The networks of the prior that a header names, as TileModel.networks.");
  nb::class_<sgi::Mask>(m, "Mask", "Which pixels of a tile hold nothing.")
      .def(
          "__init__", [](sgi::Mask *self, int64_t width, int64_t height) { new (self) sgi::Mask(width, height); },
          "width"_a, "height"_a, "That of a tile in which no pixel holds anything.")
      .def_prop_ro("nbytes", &sgi::Mask::memory)
      .def("at", &mask_at, nb::rv_policy::move, "rows"_a, "columns"_a,
           "The mask [rows, columns] where ascending rows and columns of pixels meet.");
  m.def(
      "decode_tile_chunk", &decode_tile_chunk, "header"_a, "payload"_a,
      "Of the payload of a chunk T: the tile's number; whether no pixel of it holds anything; masks, one for all "
      "bands\n"
      "or one for each (whether it holds nothing, and its mask or None), none where all pixels hold something; exact\n"
      "samples (place, value); the payload of its model.");
}
