// For small functions of headers that units of different instruction sets share: a copy of one must never serve
// another.
#pragma once

#define SGI_INLINE __attribute__((always_inline)) inline
