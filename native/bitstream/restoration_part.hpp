// The restoration part of a tile, and the networks that it may name (docs/format.md, "Restoration").
#pragma once
#include "bitstream/symbol_reader.hpp"
#include "model/restoration.hpp"

namespace sgi {

constexpr int kOwnNetwork = 15;  // the number of the picture's own

// The network of a number: a shipped one, or that of the picture, whose file is `own`. Throws Error: unsupported for
// one that this version does not have, corrupt for one that the picture does not have.
std::shared_ptr<const RestorationNetwork> restoration_network(int number, Bytes own);

// What a tile states. Throws as above.
RestorationChoice read_restoration_part(SymbolReader &reader, Bytes own);

}  // namespace sgi
