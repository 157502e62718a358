#include "image/drain.hpp"

#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

#include <cerrno>
#include <vector>

namespace sgi {

namespace {

constexpr unsigned BLOCK = 1 << 16;

// Returns the number of an error, 0 for none.
int write_all(int to, const char *data, unsigned size) {
  while (size > 0) {
    const auto done = write(to, data, size);
    if (done < 0 && errno != EINTR) return errno;
    if (done > 0) {
      data += done;
      size -= unsigned(done);
    }
  }
  return 0;
}

void drain(int from, int to, std::shared_ptr<std::atomic<int>> error) {
  std::vector<char> block(BLOCK);
  for (;;) {
    const auto size = read(from, block.data(), BLOCK);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0 && *error == 0) *error = errno;
    if (size <= 0) break;
    if (*error == 0) *error = write_all(to, block.data(), unsigned(size));
  }
  close(from);
  if (to >= 0) close(to);
}

}  // namespace

Drain::Drain(int from, int to) : error_(std::make_shared<std::atomic<int>>(0)) {
  const int copy = dup(to);
  if (copy < 0) *error_ = errno;
  thread_ = std::thread(drain, from, copy, error_);
}

Drain::~Drain() {
  if (thread_.joinable()) thread_.detach();
}

int Drain::join() {
  if (thread_.joinable()) thread_.join();
  return *error_;
}

}  // namespace sgi
