// All attributes of a tile's seeds, pass after pass (docs/format.md, "Passes"), from symbols to values: what writing
// does step by step in Python, with the same functions.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "bitstream/read_symbols.hpp"
#include "model/context.hpp"
#include "model/hash_grid.hpp"
#include "model/network.hpp"

namespace sgi {

// A group of attributes: how MLP_p's outputs predict it and where it goes.
struct AttributeGroup {
  std::vector<int64_t> base;     // [size, kLevels] base step index of each attribute
  std::vector<int64_t> columns;  // [size] which of the group's predictions belongs to each
  int64_t gamma;
  bool follows_amplitude;
  int64_t prediction, refinement;  // its first mean, and its refinement, among those of the step
  int64_t first;                   // its first column

  int size() const { return int(columns.size()); }
};

// A coding step: one network, and the groups that it predicts.
struct AttributeStep {
  std::unique_ptr<Network> network;
  int inputs, predicted;
  std::vector<AttributeGroup> groups;
};

struct AttributeModel {
  std::vector<AttributeStep> steps;
  int64_t attributes;  // d_A
  int channels, colour, shape;
  int quality, ranks;   // of neighbours, 0 for none
  int16_t first_table;  // of the family
  Isa isa;
  const HashGrid *grid = nullptr;  // null for none
  const uint8_t *grid_signs = nullptr;
};

struct TileSeeds {
  SeedsView view;
  int64_t count;
  std::vector<std::vector<int64_t>> passes;
};

struct AttributesRead {
  std::vector<int32_t> symbols;  // all in coding order
  std::vector<double> bits;      // information content of every group
};

// Writes decoded [N, attributes], units of 2^-24, but for seeds of no pass. With two threads or more the neighbours of
// a pass are searched while the one before is read.
Reading read_attributes(RangeDecoder &decoder, const AttributeModel &model, const ZeroCentred &tables,
                        const TileSeeds &seeds, int threads, int64_t *decoded, AttributesRead &read);

}  // namespace sgi
