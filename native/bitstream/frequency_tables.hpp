// The zero-centred frequency tables of the format (docs/format.md, "Zero-centred tables").
#pragma once
#include <cstdint>
#include <vector>

#include "bitstream/range_decoder.hpp"

namespace sgi {

constexpr int kTables = 128;                     // two families of 64
constexpr int kMaxMagnitude = 1 << 20;           // of a symbol
constexpr int kTableBits = 7, kFamilySize = 64;  // of a table's number; tables of a family

struct FrequencyTables {
  std::vector<int32_t> support;    // of each table: symbols from -support to support, and an escape
  SymbolModels models, exponents;  // of the tables; of what stands behind an escape
};

// Made once.
const FrequencyTables &frequency_tables();

}  // namespace sgi
