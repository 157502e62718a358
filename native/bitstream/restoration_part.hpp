// The restoration part of a tile, and the networks that it may name (docs/format.md, "Restoration").
#pragma once
#include "bitstream/symbol_reader.hpp"
#include "model/restoration.hpp"

namespace sgi {

// The shipped network of a number. Throws Error (unsupported) for one that this version does not have.
const std::shared_ptr<const RestorationNetwork> &restoration_network(int number);

// What a tile states. Throws as above.
RestorationChoice read_restoration_part(SymbolReader &reader);

}  // namespace sgi
