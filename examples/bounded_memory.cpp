// All memory of libsgi, of each of its threads, comes from operator new, which a program may replace: by its own heap,
// or, as here, by one that gives no more than SGI_BYTES at a time. Where it throws, a call returns SGI_ERROR_MEMORY.
// c++ -c bounded_memory.cpp && cc -c decode.c $(pkg-config --cflags sgi) &&
// c++ decode.o bounded_memory.o -o decode $(pkg-config --libs sgi)
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t kHead = alignof(std::max_align_t);  // where a block keeps its size

std::atomic<std::size_t> held{0};

std::size_t bound() {
  static const char *const text = std::getenv("SGI_BYTES");
  static const std::size_t bytes = text ? std::strtoull(text, nullptr, 10) : SIZE_MAX;
  return bytes;
}

}  // namespace

void *operator new(std::size_t size) {
  const std::size_t whole = size + kHead;
  if (whole < size || held.fetch_add(whole) + whole > bound()) {
    held -= whole;
    throw std::bad_alloc();
  }
  auto *const block = static_cast<std::size_t *>(std::malloc(whole));
  if (!block) {
    held -= whole;
    throw std::bad_alloc();
  }
  *block = whole;
  return reinterpret_cast<char *>(block) + kHead;
}

void operator delete(void *given) noexcept {
  if (!given) return;
  auto *const block = reinterpret_cast<std::size_t *>(static_cast<char *>(given) - kHead);
  held -= *block;
  std::free(block);
}

void operator delete(void *given, std::size_t) noexcept { operator delete(given); }
