#include "base/heap.hpp"

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>

#include <climits>
#endif

namespace sgi {

void keep_freed_memory() {
#ifdef __GLIBC__
  constexpr int kMaxOnHeap = 32 << 20;  // bytes of one allocation, the most that glibc takes
  mallopt(M_MMAP_THRESHOLD, kMaxOnHeap);
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
#endif
}

}  // namespace sgi
