// The CRC-32 of zlib, PNG and Ethernet.
#pragma once
#include <cstdint>

#include "base/bytes.hpp"

namespace sgi {

// That of what came `before` and of these bytes.
uint32_t crc32(Bytes bytes, uint32_t before = 0);

}  // namespace sgi
