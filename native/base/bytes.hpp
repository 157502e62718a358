// Bytes that somebody else holds.
#pragma once
#include <cstddef>
#include <cstdint>

namespace sgi {

struct Bytes {
  const uint8_t *data = nullptr;
  size_t size = 0;

  // Those from `begin` on.
  Bytes from(size_t begin) const { return {data + begin, size - begin}; }
};

}  // namespace sgi
