// The tables and networks that ship with the decoder, whose numbers stand in streams (docs/format.md). Their bytes are
// those of the package's files; embed_shipped.py writes shipped.cpp when the library is built.
#pragma once
#include "base/bytes.hpp"

namespace sgi {

Bytes shipped_tables();   // the zero-centred tables
Bytes shipped_prior();    // the context model
Bytes shipped_texture();  // with what models of texture begin, inflated
Bytes shipped_restoration(
    int number);  // a network that restores pixels; without data where there is none of this number

}  // namespace sgi
