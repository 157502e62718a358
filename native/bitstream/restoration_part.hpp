// The restoration part of a tile, and the networks that it may name (docs/format.md, "Restoration").
#pragma once
#include "bitstream/symbol_reader.hpp"
#include "model/restoration.hpp"

namespace sgi {

constexpr int kOwnNetwork = 15;  // the number of the picture's own

using SharedNetwork = std::shared_ptr<const RestorationNetwork>;  // null for none

// The network of a number: a shipped one, or that of the picture. Throws Error: unsupported for one that this version
// does not have, corrupt for one that the picture does not have.
const SharedNetwork &restoration_network(int number, const SharedNetwork &own);

// What a tile states. Throws as above.
RestorationChoice read_restoration_part(SymbolReader &reader, const SharedNetwork &own);

}  // namespace sgi
