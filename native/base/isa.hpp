// Instruction sets: which one to run, and the functions compiled for it.
//
// CMake compiles every *_kernels.cpp once per set, with SGI_ISA (its name below) and LANES (floats in a vector)
// defined. Such a file defines the table of its functions, `const TileKernel TileKernel::SGI_ISA{...}`, and keeps all
// else in an unnamed namespace. It uses no templates of the standard library: the linker might take an instantiation
// that another processor cannot run.
#pragma once
#include <string>

namespace sgi {

enum class Isa { portable, avx2, avx512 };

// The set of this name; "auto" is the widest that this processor has. Throws std::invalid_argument for one it lacks.
Isa choose_isa(const std::string &name);

const char *name_of(Isa isa);

// Floats in a vector.
constexpr int lanes_of(Isa isa) { return isa == Isa::avx512 ? 16 : isa == Isa::avx2 ? 8 : 4; }

// The one dispatcher. Kernel: a struct of functions with one static table per set.
template <class Kernel>
const Kernel &kernel_for(Isa isa) {
#ifdef SGI_X86
  if (isa == Isa::avx512) return Kernel::avx512;
  if (isa == Isa::avx2) return Kernel::avx2;
#endif
  (void)isa;
  return Kernel::portable;
}

}  // namespace sgi
