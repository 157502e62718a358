// The restoration part of a tile, and the networks that it may name (docs/format.md, "Restoration").
#pragma once
#include "bitstream/symbol_reader.hpp"
#include "model/restoration.hpp"

namespace sgi {

// The network of a choice. Throws Error: unsupported for one that this version does not have, corrupt for changes that
// it cannot have.
std::shared_ptr<const RestorationNetwork> restoration_network(const RestorationChoice &choice);

// What a tile states. Throws as above.
RestorationChoice read_restoration_part(SymbolReader &reader);

}  // namespace sgi
