// All attributes of a tile's seeds, pass after pass (docs/format.md, "Passes"): the one walk of reading and writing.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "model/context.hpp"
#include "model/hash_grid.hpp"

namespace sgi {

struct AttributeModel {
  std::vector<AttributeStep> steps;
  int64_t attributes;  // d_A
  int channels, colour, shape;
  int colour_step, ranks;  // of neighbours, 0 for none
  int16_t first_table;     // of the family
  Isa isa;
  const HashGrid *grid = nullptr;  // null for none
  const uint8_t *grid_signs = nullptr;
};

// Seeds in cells with these corners [N, 2] and log2 of sides [N], which must outlive it, and the passes that code them.
struct TileSeeds {
  TileSeeds(const ContextSpec &context, const std::vector<int32_t> &corner, const std::vector<int8_t> &log_size);

  std::vector<int32_t> half_pixels;  // [N, 2] of centres
  SeedsView view;
  int64_t count;
  std::vector<std::vector<int64_t>> passes;
};

// Of every pass the nearest seeds of earlier ones [n, ranks], nearest first, -1 where there is none.
std::vector<std::vector<int32_t>> neighbours_by_pass(const TileSeeds &seeds, int ranks, Isa isa);

// Symbols of a group for the seeds of a pass [n, size], and how they are coded.
struct AttributeRun {
  size_t number;  // of the group, in coding order
  const AttributeGroup &group;
  const std::vector<int64_t> &members;
  const int64_t *mean, *step;  // [n, size]
  const int16_t *tables;       // [n, size]

  int64_t count() const { return int64_t(members.size()) * group.size(); }
};

// Says what symbols are, one run after the other.
using AttributeSymbols = std::function<void(const AttributeRun &run, int32_t *symbols)>;

// Says the symbols nearest to values [N, attributes], but for a lean towards zero by what the bits are worth,
// `kDeadZone` for a scale of one step, under a Laplacian: Gaussian attributes are fitted without. A decoder need not
// know.
AttributeSymbols nearest_symbols(const AttributeModel &model, const double *values);

// Writes decoded [N, attributes], units of 2^-24, but for seeds of no pass. With two threads or more the neighbours of
// a pass are searched while the one before is coded.
void code_attributes(const AttributeSymbols &coder, const AttributeModel &model, const TileSeeds &seeds, int threads,
                     int64_t *decoded);

}  // namespace sgi
