// Structures of callers who know an earlier or a later version of the interface.
#pragma once
#include <sgi.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

#include "capi/status.hpp"

namespace sgi::capi {

constexpr size_t kMaxStruct = 4096;  // bytes; more is a size that was never set

// Up to the last field that each program has: it may know no later one.
constexpr size_t kMinOptions = offsetof(sgi_options, tile_bytes) + sizeof(sgi_options::tile_bytes);
constexpr size_t kMinInfo = offsetof(sgi_info, file_bytes) + sizeof(sgi_info::file_bytes);
constexpr size_t kMinView = offsetof(sgi_view, no_dither) + sizeof(sgi_view::no_dither);

inline size_t size_of(const void *given, size_t least, const char *name) {
  require(given, "a null pointer");
  size_t size;
  std::memcpy(&size, given, sizeof size);
  if (size < least || size > kMaxStruct)
    misuse(std::string(name) + ".struct_size is " + std::to_string(size) + "; set it to sizeof(" + name + ")");
  return size;
}

// What a caller gave: what is beyond this version must be 0.
template <class T>
T taken(const T *given, size_t least, const char *name) {
  const size_t size = size_of(given, least, name), known = std::min(size, sizeof(T));
  const auto *bytes = reinterpret_cast<const unsigned char *>(given);
  if (std::any_of(bytes + known, bytes + size, [](unsigned char byte) { return byte; }))
    misuse(std::string(name) + " asks for what this version of the library does not know");
  T copy{};
  std::memcpy(&copy, given, known);
  return copy;
}

// Fills what a caller wants filled.
template <class T>
void give(T *wanted, T found, size_t least, const char *name) {
  found.struct_size = size_of(wanted, least, name);
  std::memset(static_cast<void *>(wanted), 0, found.struct_size);
  std::memcpy(static_cast<void *>(wanted), &found, std::min(found.struct_size, sizeof found));
}

}  // namespace sgi::capi
