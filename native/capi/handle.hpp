// What a handle of the C interface is.
#pragma once
#include <sgi.h>

#include <vector>

#include "capi/status.hpp"
#include "decoder/stream.hpp"

struct sgi_stream {
  sgi::Stream stream;
  std::vector<sgi::Level> levels;
};

namespace sgi::capi {

inline sgi_stream &checked(sgi_stream *stream) {
  require(stream, "a null pointer for the stream");
  return *stream;
}

}  // namespace sgi::capi
