// A tile's model, from what Python's TileModel holds.
#pragma once
#include <nanobind/stl/string.h>

#include <string>

#include "bindings/checks.hpp"
#include "bitstream/context_model.hpp"
#include "bitstream/tile.hpp"

namespace sgi {

constexpr const char *kGroupNames[] = {"colour", "shape", "feature", "scales", "offset"};

// Steps of texture of a Python TextureIndices, for so many channels; its layer of a Python TextureSymbols.
TextureIndices indices_of(nanobind::handle steps, size_t channels);
CodedTexture texture_of(nanobind::handle layer);

// Its seeds and how they are coded; and all of it. The attributes are given apart.
TileModel seeds_of(const Header &header, nanobind::handle model);
TileModel tile_model_of(const Header &header, nanobind::handle model);

// Its attributes [N, d_A] in coding order.
std::vector<double> attributes_of(const Header &header, nanobind::handle model);

// How the seeds of a model are coded.
struct SeedCoding {
  Header header;
  TileModel tile;
  HashGrid grid;
  AttributeModel model;
  TileSeeds seeds;

  SeedCoding(const nanobind::bytes &fields, nanobind::handle of, const std::string &isa)
      : header(decode_header(bytes_of(fields))), tile(seeds_of(header, of)),
        grid(header.spec.context, header.width, header.height),
        model(attribute_model(header.spec, tile.coding.plan, tile.coding.networks, header.colour_step, header.family,
                              choose_isa(isa))),
        seeds(header.spec.context, tile.corner, tile.log_size) {
    if (!tile.coding.signs.empty()) model.grid = &grid, model.grid_signs = tile.coding.signs.data();
  }
  SeedCoding(const SeedCoding &) = delete;
};

}  // namespace sgi
