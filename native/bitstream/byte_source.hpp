// What gives the bytes of a file.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/bytes.hpp"

namespace sgi {

struct ByteRange {
  uint64_t offset, count;
};

// Throws Error (source), or whatever else its maker expects, where it fails.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Bytes of the whole, or none for one that can only be read once from its start.
  virtual std::optional<uint64_t> size() = 0;
  // Reads up to `count` bytes from `offset` on; fewer only at the end. Without a size, offsets never go back.
  virtual size_t read(uint64_t offset, uint8_t *out, size_t count) = 0;
  // Tells which bytes are read next: a source that is far away may fetch them together.
  virtual void expect(const std::vector<ByteRange> &) {}
};

// Bytes in memory, which must outlive it.
std::unique_ptr<ByteSource> memory_source(Bytes bytes);

}  // namespace sgi
