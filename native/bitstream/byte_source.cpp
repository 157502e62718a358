#include "bitstream/byte_source.hpp"

#include <algorithm>
#include <cstring>

namespace sgi {

namespace {

class MemorySource : public ByteSource {
 public:
  explicit MemorySource(Bytes bytes) : bytes_(bytes) {}

  std::optional<uint64_t> size() override { return bytes_.size; }

  size_t read(uint64_t offset, uint8_t *out, size_t count) override {
    if (offset >= bytes_.size || !count) return 0;
    const size_t found = std::min<size_t>(count, bytes_.size - size_t(offset));
    std::memcpy(out, bytes_.data + offset, found);
    return found;
  }

 private:
  const Bytes bytes_;
};

}  // namespace

std::unique_ptr<ByteSource> memory_source(Bytes bytes) { return std::make_unique<MemorySource>(bytes); }

}  // namespace sgi
