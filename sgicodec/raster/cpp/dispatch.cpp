// The tile kernels of this build, chosen at run time.
#include <stdexcept>

#include "finish.hpp"
#include "kernel.hpp"

namespace sgi {

const TileKernel &choose_kernel(const std::string &isa) {
#ifdef SGI_X86
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#ifdef SGI_NO_AVX512
  const bool has_avx512 = false;
#else
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#endif
  if (isa == "avx512" || (isa == "auto" && has_avx512)) {
    if (!has_avx512) throw std::invalid_argument("this processor has no AVX-512");
    return avx512_kernel();
  }
  if (isa == "avx2" || (isa == "auto" && has_avx2)) {
    if (!has_avx2) throw std::invalid_argument("this processor has no AVX2 with FMA");
    return avx2_kernel();
  }
#endif
  if (isa == "portable" || isa == "auto") return portable_kernel();
  throw std::invalid_argument("unknown instruction set '" + isa + "': use auto, avx512, avx2 or portable");
}

FinishTile finish_for(const TileKernel &kernel) {
#ifdef SGI_X86
  if (&kernel == &avx512_kernel()) return finish_avx512;
  if (&kernel == &avx2_kernel()) return finish_avx2;
#endif
  (void)kernel;
  return finish_portable;
}

}  // namespace sgi
