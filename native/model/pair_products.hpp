// Products of pairs of 16-bit integers, summed in 32 bits: for *_kernels.cpp that include <immintrin.h> on x86.
#pragma once
#include <cstdint>

namespace sgi {
namespace {
namespace narrow {

using vi = int32_t __attribute__((vector_size(LANES * 4)));
using Wrapping = uint32_t __attribute__((vector_size(LANES * 4)));

// Of each lane the product of the lower halves plus that of the upper halves.
inline vi multiply_pairs(vi a, vi b) {
#if defined(SGI_X86) && LANES == 16
  return (vi)_mm512_madd_epi16((__m512i)a, (__m512i)b);
#elif defined(SGI_X86) && LANES == 8
  return (vi)_mm256_madd_epi16((__m256i)a, (__m256i)b);
#elif defined(SGI_X86)
  return (vi)_mm_madd_epi16((__m128i)a, (__m128i)b);
#elif defined(__wasm_simd128__)
  using vs = short __attribute__((vector_size(16)));
  return (vi)__builtin_wasm_dot_s_i32x4_i16x8((vs)a, (vs)b);
#else
  return ((a << 16) >> 16) * ((b << 16) >> 16) + (a >> 16) * (b >> 16);
#endif
}

// sum plus those products, which may wrap around: FUSED where the processor has one instruction for both.
template <bool FUSED>
inline vi add_products(vi sum, vi a, vi b) {
#if defined(SGI_X86) && LANES == 16
  if constexpr (FUSED) {
    asm("vpdpwssd %2, %1, %0" : "+v"(sum) : "v"(a), "v"(b));
    return sum;
  }
#endif
  return (vi)((Wrapping)sum + (Wrapping)multiply_pairs(a, b));
}

inline bool has_fused() {
#if defined(SGI_X86) && LANES == 16
  return __builtin_cpu_supports("avx512vnni");
#else
  return false;
#endif
}

inline vi load(const int32_t *p) {
  vi v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

inline void store(int32_t *p, vi v) { __builtin_memcpy(p, &v, sizeof v); }

inline vi clipped(vi v, int32_t low, int32_t high) {
  const vi least = vi{} + low, most = vi{} + high;
  v = v < least ? least : v;
  return v > most ? most : v;
}

}  // namespace narrow
}  // namespace
}  // namespace sgi
