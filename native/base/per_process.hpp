// Objects that all threads of a process share.
#pragma once

#if !defined(_WIN32) && !defined(__EMSCRIPTEN__)
#include <pthread.h>
#endif

namespace sgi {

// The T of this process. It never ends: others' static objects may use it. A forked child has a new one: threads of the
// old one are not there, and its locks may be held for ever.
template <class T>
T &per_process() {
  static T *one = new T;
#if !defined(_WIN32) && !defined(__EMSCRIPTEN__)
  static const int watched = pthread_atfork(nullptr, nullptr, [] { one = new T; });
  (void)watched;
#endif
  return *one;
}

}  // namespace sgi
