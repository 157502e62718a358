// A persistent pool for loops over independent items. Which thread takes which item never changes a result.
#pragma once
#include <cstdint>
#include <functional>

namespace sgi {

// Runs body(i) for every i in [0, n) on at most `threads` threads (0 = one per core) and returns when all are done, or
// throws the first exception that one of them threw. A loop that a body starts runs within that body's thread alone.
void parallel_for(int64_t n, int threads, const std::function<void(int64_t)> &body);

// The number of threads that `threads` (0 = one per core) stands for.
int resolve_threads(int threads);

}  // namespace sgi
