// The zero-centred frequency tables of the format (docs/format.md, "Zero-centred tables").
#pragma once
#include "bitstream/read_symbols.hpp"

namespace sgi {

constexpr int kTables = 128;                     // two families of 64
constexpr int kMaxMagnitude = 1 << 20;           // of a symbol
constexpr int kTableBits = 7, kFamilySize = 64;  // of a table's number; tables of a family

// What reads zero-centred symbols, escapes included; made once.
const ZeroCentred &zero_centred_tables();

}  // namespace sgi
