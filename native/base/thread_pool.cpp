#include "base/thread_pool.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/per_process.hpp"

#ifdef SGI_X86
#include <immintrin.h>
#endif
#ifdef __linux__
#include <sched.h>
#endif

namespace sgi {
namespace {

// Floats as IEEE 754 has them while a body runs, whatever a library has set for the thread: rounded to nearest, with
// denormals. What is decoded depends on it.
class IeeeFloats {
 public:
#ifdef SGI_X86
  IeeeFloats() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ & ~0xe040u); }
  ~IeeeFloats() { _mm_setcsr(saved_); }

 private:
  const unsigned saved_;
#endif
};

thread_local bool in_loop = false;  // this thread runs a body

class InLoop {
 public:
  InLoop() : before_(in_loop) { in_loop = true; }
  ~InLoop() { in_loop = before_; }

 private:
  const bool before_;
};

struct Job {
  const std::function<void(int64_t)> *body;
  int64_t n;
  std::atomic<int64_t> next{0};
  int slots;        // helpers that may still join; behind the pool's lock, as is the next
  int helpers = 0;  // at work
  std::mutex failing;
  std::exception_ptr failure;  // the first; it ends the loop and is thrown again where the loop was called

  void work() {
    IeeeFloats ieee;
    InLoop mark;
    try {
      for (int64_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < n;) (*body)(i);
    } catch (...) {
      next.store(n, std::memory_order_relaxed);
      std::lock_guard<std::mutex> lock(failing);
      if (!failure) failure = std::current_exception();
    }
  }
};

// Helpers that loops of several callers share: each caller works on its own loop.
class Pool {
 public:
  // From here on helpers join.
  void open(Job &job) {
    {
      std::lock_guard<std::mutex> lock(mutex_);
      try {
        for (; workers_ < job.slots; ++workers_) std::thread([this] { loop(); }).detach();
      } catch (const std::system_error &) {  // no more threads to be had: fewer will do
      }
      jobs_.push_back(&job);
    }
    wake_.notify_all();
  }

  // Waits for those that have joined; others are not needed any more.
  void close(Job &job) {
    std::unique_lock<std::mutex> lock(mutex_);
    jobs_.erase(std::find(jobs_.begin(), jobs_.end(), &job));
    done_.wait(lock, [&] { return job.helpers == 0; });
  }

 private:
  void loop() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      Job *job = nullptr;
      wake_.wait(lock, [&] { return (job = neediest()) != nullptr; });
      --job->slots;
      ++job->helpers;
      lock.unlock();
      job->work();
      lock.lock();
      job->slots = 0;  // nothing is left to begin
      if (--job->helpers == 0) done_.notify_all();
    }
  }

  // The loop with the fewest helpers of those that more may join; null where there is none.
  Job *neediest() const {
    Job *found = nullptr;
    for (Job *job : jobs_)
      if (job->slots > 0 && (!found || job->helpers < found->helpers)) found = job;
    return found;
  }

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  std::vector<Job *> jobs_;
  int workers_ = 0;
};

Pool &pool() { return per_process<Pool>(); }

}  // namespace

int resolve_threads(int threads) {
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
  (void)threads;  // there is but one, and waiting for another would not end
  return 1;
#else
  if (threads > 0) return threads;
#ifdef __linux__
  cpu_set_t own;
  if (sched_getaffinity(0, sizeof own, &own) == 0) return CPU_COUNT(&own);
#endif
  return std::max(1u, std::thread::hardware_concurrency());
#endif
}

void parallel_for(int64_t n, int threads, const std::function<void(int64_t)> &body) {
  if (n <= 0) return;
  Job job;
  job.body = &body;
  job.n = n;
  job.slots = static_cast<int>(std::min<int64_t>(resolve_threads(threads), n)) - 1;
  if (job.slots <= 0 || in_loop) {
    job.work();
  } else {
    pool().open(job);
    job.work();
    pool().close(job);
  }
  if (job.failure) std::rethrow_exception(job.failure);
}

struct Task::Parts {
  std::function<void(int64_t)> body;
  Job job;
  bool is_open;

  void close() {
    if (is_open) pool().close(job);
    is_open = false;
  }
};

Task::Task(int threads, std::function<void()> body) : parts_(new Parts) {
  Parts &parts = *parts_;
  parts.body = [body = std::move(body)](int64_t) { body(); };
  parts.job.body = &parts.body;
  parts.job.n = 1;
  parts.job.slots = std::min(1, resolve_threads(threads) - 1);
  parts.is_open = parts.job.slots > 0 && !in_loop;
  if (parts.is_open) pool().open(parts.job);
}

Task::~Task() { parts_->close(); }

void Task::begin() { parts_->job.work(); }

void Task::wait() {
  begin();
  parts_->close();
  if (parts_->job.failure) std::rethrow_exception(parts_->job.failure);
}

}  // namespace sgi
