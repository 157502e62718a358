#include "base/isa.hpp"

#include <stdexcept>

namespace sgi {
namespace {

bool runs(Isa isa) {
#ifdef SGI_X86
  if (isa == Isa::avx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#ifndef SGI_NO_AVX512
  if (isa == Isa::avx512)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
#endif
#endif
  return isa == Isa::portable;
}

}  // namespace

const char *name_of(Isa isa) { return isa == Isa::avx512 ? "avx512" : isa == Isa::avx2 ? "avx2" : "portable"; }

Isa choose_isa(const std::string &name) {
  for (const Isa isa : {Isa::avx512, Isa::avx2, Isa::portable}) {
    if (name != "auto" && name != name_of(isa)) continue;
    if (runs(isa)) return isa;
    if (name != "auto") throw std::invalid_argument("this processor does not run " + name);
  }
  throw std::invalid_argument("unknown instruction set '" + name + "': use auto, avx512, avx2 or portable");
}

}  // namespace sgi
