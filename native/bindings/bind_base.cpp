#include <nanobind/stl/string.h>

#include "base/heap.hpp"
#include "base/isa.hpp"
#include "base/peak.hpp"
#include "base/thread_pool.hpp"
#include "bindings/bindings.hpp"

namespace nb = nanobind;
using namespace nb::literals;

void bind_base(nb::module_ &m) {
  m.def("keep_freed_memory", &sgi::keep_freed_memory);
  m.def("resolve_threads", &sgi::resolve_threads, "threads"_a);
  m.def(
      "instruction_set", [](const std::string &isa) { return std::string(sgi::name_of(sgi::choose_isa(isa))); },
      "isa"_a);
  m.def(
      "fma_peak", [](int threads, const std::string &isa) { return sgi::fma_peak(threads, sgi::choose_isa(isa)); },
      nb::call_guard<nb::gil_scoped_release>(), "threads"_a, "isa"_a);
}
