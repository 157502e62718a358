#include <nanobind/stl/string.h>

#include "base/heap.hpp"
#include "base/isa.hpp"
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
}
