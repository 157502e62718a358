// Shipped integers as planes of their bytes, which compress better where a page fetches them with the library.
#pragma once
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"

namespace sgi {

// The integers of 2 or 4 bytes, little-endian, of which `planes` holds all lowest bytes, then all next ones ... Those
// of 2 bytes are signed, and 2 n stands for n, -2 n - 1 for a negative one.
std::vector<uint8_t> joined_planes(Bytes planes, int width);

}  // namespace sgi
