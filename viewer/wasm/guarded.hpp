// Errors of what the workers call: texts, since nothing may throw into JavaScript.
#pragma once
#include <exception>
#include <new>
#include <string>

namespace sgi {

inline std::string last_error;

// Runs body(): what it returns, or `failed` with the error's text kept.
template <class Result, class Body>
Result guarded(Result failed, Body body) {
  try {
    return body();
  } catch (const std::bad_alloc &) {
    last_error = "there is not enough memory for this";
  } catch (const std::exception &error) {
    last_error = error.what();
  }
  return failed;
}

}  // namespace sgi
