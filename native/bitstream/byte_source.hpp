// What gives the bytes of a file.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "base/bytes.hpp"

namespace sgi {

// Throws Error (source), or whatever else its maker expects, where it fails.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Bytes of the whole, or none for one that can only be read once from its start.
  virtual std::optional<uint64_t> size() = 0;
  // Reads up to `count` bytes from `offset` on; fewer only at the end. Without a size, offsets never go back.
  virtual size_t read(uint64_t offset, uint8_t *out, size_t count) = 0;
};

// Bytes in memory, which must outlive it.
std::unique_ptr<ByteSource> memory_source(Bytes bytes);

}  // namespace sgi
