// A persistent pool for loops over independent items. Which thread takes which item never changes a result.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>

namespace sgi {

// Runs body(i) for every i in [0, n) on at most `threads` threads (0 = one per core) and returns when all are done, or
// throws the first exception that one of them threw. A loop that a body starts runs within that body's thread alone.
void parallel_for(int64_t n, int threads, const std::function<void(int64_t)> &body);

// A body that a thread of the pool begins as soon as one is free, or, of one thread, who waits for it. Its own loops
// run within that thread alone.
class Task {
 public:
  Task(int threads, std::function<void()> body);
  ~Task();  // waits for it if it was begun
  Task(const Task &) = delete;

  // Runs it here, unless it was begun.
  void begin();
  // The same, and waits for its end. Throws what it threw, each time.
  void wait();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// The number of threads that `threads` (0 = one per core) stands for.
int resolve_threads(int threads);

}  // namespace sgi
