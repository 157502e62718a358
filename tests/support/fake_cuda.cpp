// A driver of a GPU that is not there: the functions of libcuda that sgicodec calls, with the kernels compiled for the
// host. Linked as libcuda.so.1, it takes the driver's place. A launch runs its blocks one after the other; memory is
// the host's. It checks what a driver would: handles, sizes of copies, kernels by name, and that what belongs to a GPU
// is used while that GPU is the thread's.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "cuda/kernels.cu"

namespace {

enum Result {
  kSuccess = 0,
  kInvalidValue = 1,
  kOutOfMemory = 2,
  kInvalidContext = 201,
  kInvalidHandle = 400,
  kNotFound = 500
};

constexpr int kMostGpus = 16;
struct Context {
} contexts[kMostGpus];  // of each GPU

bool initialised = false;
thread_local Context *current = nullptr;

struct Stream {
  Context *context = current;
};

std::mutex guard;                    // of what follows
std::map<uintptr_t, size_t> memory;  // blocks by address
size_t allocated = 0;
std::atomic<int> loaded{0};  // modules and streams

bool holds(uintptr_t at, size_t size) {
  const std::lock_guard<std::mutex> lock(guard);
  auto block = memory.upper_bound(at);
  if (block == memory.begin()) return false;
  --block;
  return at + size <= block->first + block->second;
}

}  // namespace

extern "C" {

int cuInit(unsigned) {
  initialised = true;
  return kSuccess;
}
// NVRTC asks the driver for a cache of its own, and does without.
int cuGetExportTable(const void **, const void *) { return kNotFound; }
int cuDriverGetVersion(int *version) { return *version = 13000, kSuccess; }
int cuDeviceGetCount(int *count) { return *count = 1, kSuccess; }
int cuDeviceGet(int *device, int number) {
  if (!initialised || number != 0) return kInvalidValue;
  return *device = number, kSuccess;
}
int cuDeviceGetName(char *name, int size, int) {
  std::strncpy(name, "no GPU, but this processor", size_t(size) - 1);
  return kSuccess;
}
int cuDeviceGetAttribute(int *value, int attribute, int) {
  const std::map<int, int> stated{{75, 9},
                                  {13, 1000000},
                                  {16, 4},  // compute capability 9.0, kHz, multiprocessors
                                  {36, 2000000},
                                  {37, 512}};  // kHz and bits of memory
  const auto found = stated.find(attribute);
  return *value = found == stated.end() ? 0 : found->second, kSuccess;
}
int cuDevicePrimaryCtxRetain(Context **context, int device) { return *context = &contexts[device], kSuccess; }
int cuDevicePrimaryCtxRelease_v2(int) { return kSuccess; }
int cuCtxSetCurrent(Context *context) { return current = context, kSuccess; }
int cuMemGetInfo_v2(size_t *free, size_t *total) { return *free = *total = size_t(1) << 32, kSuccess; }

int cuModuleLoadData(void **module, const void *image) {
  if (!current) return kInvalidContext;
  if (!image) return kInvalidValue;
  ++loaded;
  return *module = &memory, kSuccess;
}
int cuModuleUnload(void *) { return --loaded, current ? kSuccess : kInvalidContext; }
int cuModuleGetFunction(const sgi::HostKernel **function, void *module, const char *name) {
  if (module != &memory) return kInvalidHandle;
  for (*function = sgi::HostKernel::first(); *function; *function = (*function)->next)
    if (!std::strcmp((*function)->name, name)) return kSuccess;
  return kNotFound;
}

int cuMemAlloc_v2(uintptr_t *at, size_t size) {
  if (!current) return kInvalidContext;
  if (!size) return kInvalidValue;
  if (size > (size_t(1) << 32)) return kOutOfMemory;
  void *block = std::malloc(size);
  std::memset(block, 0xff, size);  // NaN: nothing may count on zeros
  const std::lock_guard<std::mutex> lock(guard);
  *at = reinterpret_cast<uintptr_t>(block);
  memory[*at] = size;
  allocated += size;
  return kSuccess;
}
int cuMemFree_v2(uintptr_t at) {
  if (!current) return kInvalidContext;
  const std::lock_guard<std::mutex> lock(guard);
  const auto block = memory.find(at);
  if (block == memory.end()) return kInvalidValue;
  allocated -= block->second;
  std::free(reinterpret_cast<void *>(at));
  memory.erase(block);
  return kSuccess;
}
int cuMemcpyHtoDAsync_v2(uintptr_t to, const void *from, size_t size, Stream *) {
  if (!holds(to, size)) return kInvalidValue;
  std::memcpy(reinterpret_cast<void *>(to), from, size);
  return kSuccess;
}
int cuMemcpyDtoHAsync_v2(void *to, uintptr_t from, size_t size, Stream *) {
  if (!holds(from, size)) return kInvalidValue;
  std::memcpy(to, reinterpret_cast<const void *>(from), size);
  return kSuccess;
}

int cuStreamCreate(Stream **stream, unsigned) { return ++loaded, *stream = new Stream, kSuccess; }
int cuStreamDestroy_v2(Stream *stream) { return --loaded, delete stream, kSuccess; }
int cuStreamSynchronize(Stream *) { return kSuccess; }
int cuLaunchKernel(const sgi::HostKernel *function, unsigned x, unsigned y, unsigned z, unsigned threads, unsigned,
                   unsigned, unsigned, Stream *stream, void **parameters, void **) {
  if (!current || (stream && stream->context != current)) return kInvalidContext;
  if (!function || !x || y != 1 || z != 1 || int(threads) != function->threads) return kInvalidValue;
  const char *given = static_cast<const char *>(parameters[0]);
  const std::vector<char> arguments(given, given + function->bytes);
  for (unsigned i = 0; i < x; ++i) function->run(arguments.data(), int(sgi::backwards() ? x - 1 - i : i), int(x));
  return kSuccess;
}
int cuEventCreate(void **event, unsigned) { return *event = &memory, kSuccess; }
int cuEventDestroy_v2(void *) { return kSuccess; }
int cuEventRecord(void *, Stream *) { return kSuccess; }
int cuEventSynchronize(void *) { return kSuccess; }
int cuEventElapsedTime(float *milliseconds, void *, void *) { return *milliseconds = 1.0f, kSuccess; }
int cuGetErrorString(int error, const char **text) {
  *text = error == kOutOfMemory ? "out of memory" : "invalid argument";
  return kSuccess;
}

// Lets blocks and threads run from the last to the first, or not.
void sgi_fake_backwards(int on) { sgi::backwards() = on != 0; }

// Bytes that nobody has freed.
size_t sgi_fake_allocated() { return allocated; }

// Modules and streams that are there.
int sgi_fake_loaded() { return loaded; }
}
