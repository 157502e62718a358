// The restoration part of a tile, and the networks that it may name (docs/format.md, "Restoration").
#pragma once
#include "bitstream/symbol_coder.hpp"
#include "model/restoration.hpp"

namespace sgi {

constexpr int kOwnNetwork = 15;  // the number of the picture's own

using SharedNetwork = std::shared_ptr<const RestorationNetwork>;  // null for none

// The network of a number: a shipped one, or that of the picture. Throws Error: unsupported for one that this version
// does not have, corrupt for one that the picture does not have.
const SharedNetwork &restoration_network(int number, const SharedNetwork &own);

// What a tile states. Throws as above.
template <class Coder>
void code_restoration_part(Coder &coder, const SharedNetwork &own, RestorationChoice &choice);

}  // namespace sgi
