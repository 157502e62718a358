// Bytes that Python holds or reads.
#pragma once
#include <nanobind/nanobind.h>

#include <memory>

#include "bitstream/byte_source.hpp"

namespace sgi {

// Of `bytes`, or of a binary file that stands at the start of a stream; one that cannot seek has no size. Takes the
// interpreter's lock where it needs it; what Python raises goes through.
std::unique_ptr<ByteSource> python_source(nanobind::object source);

}  // namespace sgi
