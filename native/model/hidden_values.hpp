// What hidden layers of restoration give: pairs of 16 bits, for restoration_kernels.cpp.
#pragma once
#include <cstdint>

#include "model/pair_products.hpp"
#include "model/restoration_kernel.hpp"

namespace sgi {
namespace {

// Keeps a value in a register from here on: g++ would add up products before it adds them to a sum, for which there are
// no registers, and load what it has loaded again.
inline void keep(narrow::vi &value) {
#ifdef SGI_X86
  asm("" : "+v"(value));
#endif
  (void)value;
}

inline narrow::vi activation(narrow::vi sum, int shift) { return narrow::clipped(sum >> shift, 0, kRestorationMost); }

inline narrow::vi pair_of(narrow::vi even, narrow::vi odd) { return even | odd << 16; }

// Whether all pairs with these bits have two small values.
inline bool is_small(narrow::vi bits) {
  int32_t any = 0;
  for (int i = 0; i < LANES; ++i) any |= bits[i];
  constexpr uint32_t kLarge = ~uint32_t(kRestorationSmall) & 0xffff;
  static_assert((kRestorationSmall & (kRestorationSmall + 1)) == 0);
  return !(uint32_t(any) & (kLarge | kLarge << 16));
}

}  // namespace
}  // namespace sgi
