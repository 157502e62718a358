// A thread that takes what a writer puts into a pipe and writes it to a file.
#pragma once
#include <atomic>
#include <memory>
#include <thread>

namespace sgi {

// Libraries that end the process, or never end, where a file cannot grow, write into the pipe instead, which never
// fails: after the first error, what comes is read and dropped.
class Drain {
 public:
  // Reads the descriptor `from` to its end and closes it; writes to a copy of `to`.
  Drain(int from, int to);
  // Does not wait: a thread that is left behind ends with the pipe.
  ~Drain();
  Drain(const Drain &) = delete;
  Drain &operator=(const Drain &) = delete;

  // The number of the first error so far, 0 for none.
  int error() const { return *error_; }

  // Waits for the end of the pipe; returns the same.
  int join();

 private:
  std::shared_ptr<std::atomic<int>> error_;
  std::thread thread_;
};

}  // namespace sgi
