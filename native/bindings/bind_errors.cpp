#include <exception>

#include "base/error.hpp"
#include "bindings/bindings.hpp"

namespace nb = nanobind;

namespace {

const char *class_of(sgi::Fault fault) {
  switch (fault) {
    case sgi::Fault::usage: return "UsageError";
    case sgi::Fault::region: return "RegionError";
    case sgi::Fault::corrupt: return "CorruptStreamError";
    case sgi::Fault::unsupported: return "UnsupportedStreamError";
    case sgi::Fault::limit: return "LimitError";
    case sgi::Fault::source: break;
  }
  return "StreamError";
}

}  // namespace

// Errors of the library become those of sgicodec.errors.
void bind_errors(nb::module_ &) {
  nb::register_exception_translator([](const std::exception_ptr &thrown, void *) {
    try {
      std::rethrow_exception(thrown);
    } catch (const sgi::Error &error) {
      const nb::object type = nb::module_::import_("sgicodec.errors").attr(class_of(error.fault));
      PyErr_SetString(type.ptr(), error.what());
    }
  });
}
