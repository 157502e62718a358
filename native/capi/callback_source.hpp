// Bytes that a function of the caller reads.
#pragma once
#include <sgi.h>

#include <algorithm>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "bitstream/byte_source.hpp"

namespace sgi::capi {

class CallbackSource : public ByteSource {
 public:
  CallbackSource(sgi_read read, void *user, uint64_t size) : read_(read), user_(user), size_(size) {}

  std::optional<uint64_t> size() override {
    return size_ == SGI_SIZE_UNKNOWN ? std::nullopt : std::optional<uint64_t>(size_);
  }

  size_t read(uint64_t offset, uint8_t *out, size_t count) override {
    if (size_ != SGI_SIZE_UNKNOWN) count = size_t(std::min<uint64_t>(count, size_ - std::min(size_, offset)));
    size_t found = 0;
    while (found < count) {
      const int64_t more = read_(user_, offset + found, out + found, count - found);
      if (more < 0 || uint64_t(more) > count - found) fail_at(offset + found);
      if (!more) break;
      found += size_t(more);
    }
    if (size_ != SGI_SIZE_UNKNOWN && found < count) fail_at(offset + found);
    return found;
  }

 private:
  [[noreturn]] static void fail_at(uint64_t offset) {
    throw Error(Fault::source, "reading failed at byte " + std::to_string(offset));
  }

  const sgi_read read_;
  void *const user_;
  const uint64_t size_;
};

}  // namespace sgi::capi
