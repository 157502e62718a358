// How kernels are written, so that one source runs on a GPU and, in tests, on the host.
//
// A kernel is the body of a block of threads, made of phases. `block.each(f)` calls f(t) for every thread t of the
// block, and all threads wait for each other behind it; `block.each_of_warp(f)` waits for those of a warp alone. What a
// thread keeps from one phase to the next is a PerThread, on a GPU a register; what the block shares is SGI_SHARED.
// Loops around phases must be the same for all threads. On the host a phase is a loop over threads, and shared memory
// begins as NaN.
#pragma once
#include <cstdint>

#ifndef __CUDACC__
#include <cstring>
#endif

namespace sgi {

constexpr int kWarp = 32;

#ifdef __CUDACC__

template <class T, int THREADS>
struct PerThread {
  T value;
  __device__ __forceinline__ T &operator[](int) { return value; }
};

template <int THREADS>
struct ThreadBlock {
  static constexpr int kThreads = THREADS;
  __device__ __forceinline__ int index() const { return int(blockIdx.x); }
  __device__ __forceinline__ int count() const { return int(gridDim.x); }
  template <class F>
  __device__ __forceinline__ void each(const F &f) const {
    f(int(threadIdx.x));
    __syncthreads();
  }
  template <class F>
  __device__ __forceinline__ void each_of_warp(const F &f) const {
    f(int(threadIdx.x));
    __syncwarp();
  }
  // Sums over groups of WIDTH neighbouring threads, in all of them; always in the same order.
  template <int WIDTH>
  __device__ __forceinline__ void group_sum(PerThread<float, THREADS> &v) const {
#pragma unroll
    for (int apart = WIDTH / 2; apart > 0; apart /= 2) v.value += __shfl_xor_sync(~0u, v.value, apart);
  }
  // Bit l of the mask of every thread of a warp: what lane l holds.
  __device__ __forceinline__ void ballot(PerThread<bool, THREADS> &v, PerThread<uint32_t, THREADS> &mask) const {
    mask.value = __ballot_sync(~0u, v.value);
  }
};

__device__ __forceinline__ int lowest_bit(uint32_t mask) { return __ffs(int(mask)) - 1; }

#define SGI_SHARED(Type, name) __shared__ Type name
#define SGI_KERNEL(name, THREADS, Arguments)                                                               \
  __device__ __forceinline__ void name##_body(const sgi::ThreadBlock<THREADS> &block, const Arguments &a); \
  extern "C" __global__ void __launch_bounds__(THREADS) name(const __grid_constant__ Arguments a) {        \
    name##_body(sgi::ThreadBlock<THREADS>(), a);                                                           \
  }                                                                                                        \
  __device__ __forceinline__ void name##_body(const sgi::ThreadBlock<THREADS> &block, const Arguments &a)

#else

// Whether threads run from the last to the first. What they compute must not depend on it.
inline bool &backwards() {
  static bool on = false;
  return on;
}

template <class T, int THREADS>
struct PerThread {
  T value[THREADS];
  T &operator[](int t) { return value[t]; }
};

template <int THREADS>
class ThreadBlock {
 public:
  static constexpr int kThreads = THREADS;
  ThreadBlock(int index, int count) : index_(index), count_(count) {}
  int index() const { return index_; }
  int count() const { return count_; }
  template <class F>
  void each(const F &f) const {
    for (int t = 0; t < THREADS; ++t) f(backwards() ? THREADS - 1 - t : t);
  }
  template <class F>
  void each_of_warp(const F &f) const {
    each(f);
  }
  template <int WIDTH>
  void group_sum(PerThread<float, THREADS> &v) const {
    for (int apart = WIDTH / 2; apart > 0; apart /= 2) {
      const PerThread<float, THREADS> from = v;
      for (int t = 0; t < THREADS; ++t) v.value[t] = from.value[t] + from.value[t ^ apart];
    }
  }
  void ballot(PerThread<bool, THREADS> &v, PerThread<uint32_t, THREADS> &mask) const {
    for (int warp = 0; warp < THREADS; warp += kWarp) {
      uint32_t bits = 0;
      for (int l = 0; l < kWarp; ++l) bits |= uint32_t(v.value[warp + l]) << l;
      for (int l = 0; l < kWarp; ++l) mask.value[warp + l] = bits;
    }
  }

 private:
  int index_, count_;
};

inline int lowest_bit(uint32_t mask) { return __builtin_ctz(mask); }

// A kernel by its name, to be run block by block.
struct HostKernel {
  const char *name;
  int threads;
  int bytes;  // of its arguments
  void (*run)(const void *arguments, int index, int count);
  const HostKernel *next;

  HostKernel(const char *name, int threads, int bytes, void (*run)(const void *, int, int))
      : name(name), threads(threads), bytes(bytes), run(run), next(first()) {
    first() = this;
  }
  static const HostKernel *&first() {
    static const HostKernel *list = nullptr;
    return list;
  }
};

#define SGI_SHARED(Type, name) \
  Type name;                   \
  std::memset(static_cast<void *>(&name), 0xff, sizeof name)
#define SGI_KERNEL(name, THREADS, Arguments)                                                              \
  static void name##_body(const sgi::ThreadBlock<THREADS> &block, const Arguments &a);                    \
  static const sgi::HostKernel name##_kernel(                                                             \
      #name, THREADS, int(sizeof(Arguments)), [](const void *arguments, int index, int count) {           \
        name##_body(sgi::ThreadBlock<THREADS>(index, count), *static_cast<const Arguments *>(arguments)); \
      });                                                                                                 \
  static void name##_body(const sgi::ThreadBlock<THREADS> &block, const Arguments &a)

#endif

}  // namespace sgi
