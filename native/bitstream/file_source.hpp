// Bytes of a file of the system.
#pragma once
#include <memory>

#include "bitstream/byte_source.hpp"

namespace sgi {

// Of a file that can seek, whose descriptor is duplicated. Null where the system has no such files.
std::unique_ptr<ByteSource> file_source(int descriptor);

}  // namespace sgi
