// The zero-centred frequency tables of the format (docs/format.md, "Zero-centred tables").
#pragma once
#include <cstdint>
#include <vector>

#include "bitstream/range_coder.hpp"

namespace sgi {

constexpr int kTables = 128;                     // two families of 64
constexpr int kMaxMagnitude = 1 << 20;           // of a symbol
constexpr int kTableBits = 7, kFamilySize = 64;  // of a table's number; tables of a family

struct FrequencyTables {
  std::vector<int32_t> support;    // of each table: symbols from -support to support, and an escape
  SymbolModels models, exponents;  // of the tables; of what stands behind an escape
};

// What symbols cost under the tables, in bits.
struct SymbolCosts {
  std::vector<std::vector<double>> known;  // of each table: of its symbols, then of the escape

  double bits(int64_t symbol, int table) const;
  // The table under which all symbols together cost the fewest bits.
  int best(const std::vector<int32_t> &symbols) const;
};

// Made once each; readers need no costs.
const FrequencyTables &frequency_tables();
const SymbolCosts &symbol_costs();

}  // namespace sgi
