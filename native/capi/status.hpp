// What a call throws becomes a status and a text, which stays until the thread's next call.
#pragma once
#include <sgi.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "base/error.hpp"

namespace sgi::capi {

struct Stopped {};  // thrown where the caller wants a call to end

inline thread_local char last_text[512];  // no string, which threads would have to free when the library is unloaded

inline void set_text(const char *text) {
  size_t size = std::min(std::strlen(text), sizeof last_text - 1);
  if (text[size])
    while (size && (text[size] & 0xC0) == 0x80) --size;  // no half characters
  std::memcpy(last_text, text, size);
  last_text[size] = 0;
}

inline sgi_status fail(sgi_status status, const char *text) {
  set_text(text);
  return status;
}

inline sgi_status status_of(Fault fault) {
  switch (fault) {
    case Fault::usage: return SGI_ERROR_USAGE;
    case Fault::region: return SGI_ERROR_REGION;
    case Fault::corrupt: return SGI_ERROR_CORRUPT;
    case Fault::unsupported: return SGI_ERROR_UNSUPPORTED;
    case Fault::limit: return SGI_ERROR_LIMIT;
    case Fault::source: return SGI_ERROR_SOURCE;
  }
  return SGI_ERROR_INTERNAL;
}

// Runs a body; what it throws becomes a status.
template <class Body>
sgi_status guarded(const Body &body) noexcept {
  last_text[0] = 0;
  try {
    body();
    return SGI_OK;
  } catch (const Error &error) {
    return fail(status_of(error.fault), error.what());
  } catch (const Stopped &) {
    return fail(SGI_ERROR_STOPPED, "the call was stopped");
  } catch (const std::bad_alloc &) {
    return fail(SGI_ERROR_MEMORY, "the system has no memory left");
  } catch (const std::exception &error) {
    return fail(SGI_ERROR_INTERNAL, error.what());
  } catch (...) {
    return fail(SGI_ERROR_INTERNAL, "a failure without a text");
  }
}

[[noreturn]] inline void misuse(const std::string &text) { throw Error(Fault::usage, text); }

inline void require(bool ok, const char *text) {
  if (!ok) misuse(text);
}

}  // namespace sgi::capi
