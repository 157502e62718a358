// Loops within loops, from two threads at once, and loops that wait for each other: prints how often innermost bodies
// ran and what an exception said.
#include <atomic>
#include <cstdio>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>

#include "base/thread_pool.hpp"

int main() {
  constexpr int kOuter = 16, kMiddle = 8, kInner = 4, kThreads = 4;
  std::atomic<int> runs{0};
  const auto nest = [&] {
    sgi::parallel_for(kOuter, kThreads, [&](int64_t) {
      sgi::parallel_for(kMiddle, kThreads,
                        [&](int64_t) { sgi::parallel_for(kInner, kThreads, [&](int64_t) { ++runs; }); });
    });
  };
  std::thread other(nest);
  nest();
  other.join();
  std::string said = "nothing";
  try {
    sgi::parallel_for(kOuter, kThreads, [&](int64_t) {
      sgi::parallel_for(kInner, kThreads, [&](int64_t) { throw std::runtime_error("a reason"); });
    });
  } catch (const std::runtime_error &error) {
    said = error.what();
  }
  sgi::parallel_for(kInner, kThreads, [&](int64_t) { ++runs; });  // the pool still works
  // Each of four loops ends only when all have begun: none waits for its turn.
  constexpr int kCallers = 4;
  std::atomic<int> begun{0};
  std::promise<void> all;
  const std::shared_future<void> go = all.get_future().share();
  const auto meet = [&] {
    std::atomic<bool> first{true};
    sgi::parallel_for(kInner, kThreads, [&](int64_t) {
      if (first.exchange(false) && ++begun == kCallers) all.set_value();
      go.wait();
      ++runs;
    });
  };
  std::thread callers[kCallers];
  for (std::thread &caller : callers) caller = std::thread(meet);
  for (std::thread &caller : callers) caller.join();
  std::printf("%d of %d, %s\n", runs.load(), 2 * kOuter * kMiddle * kInner + kInner + kCallers * kInner, said.c_str());
}
