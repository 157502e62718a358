// The first bytes of a file whose rest is not there yet.
#pragma once
#include <cstring>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "bitstream/byte_source.hpp"

namespace sgi::capi {

class PrefixSource : public ByteSource {
 public:
  explicit PrefixSource(Bytes bytes) : bytes_(bytes) {}

  std::optional<uint64_t> size() override { return std::nullopt; }

  size_t read(uint64_t offset, uint8_t *out, size_t count) override {
    if (offset > bytes_.size || count > bytes_.size - offset)
      throw Error(Fault::source, "the first " + std::to_string(bytes_.size) + " bytes do not hold the whole header");
    std::memcpy(out, bytes_.data + offset, count);
    return count;
  }

 private:
  const Bytes bytes_;
};

}  // namespace sgi::capi
