#include "bitstream/file_source.hpp"

#ifndef _WIN32
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.hpp"
#endif

namespace sgi {

#ifdef _WIN32

std::unique_ptr<ByteSource> file_source(int) { return nullptr; }

#else

namespace {

[[noreturn]] void fail() { throw Error(Fault::source, std::strerror(errno)); }

class FileSource : public ByteSource {
 public:
  explicit FileSource(int descriptor) : descriptor_(::dup(descriptor)) {
    if (descriptor_ < 0) fail();
  }
  ~FileSource() override { ::close(descriptor_); }

  std::optional<uint64_t> size() override {
    const off_t end = ::lseek(descriptor_, 0, SEEK_END);
    if (end < 0) fail();
    return uint64_t(end);
  }
  size_t read(uint64_t offset, uint8_t *out, size_t count) override {
    size_t done = 0;
    while (done < count) {
      const ssize_t more = ::pread(descriptor_, out + done, count - done, off_t(offset + done));
      if (more < 0 && errno != EINTR) fail();
      if (more == 0) break;
      if (more > 0) done += size_t(more);
    }
    return done;
  }

 private:
  const int descriptor_;
};

}  // namespace

std::unique_ptr<ByteSource> file_source(int descriptor) { return std::make_unique<FileSource>(descriptor); }

#endif

}  // namespace sgi
