// Limits of a tile, checked before memory or time is spent: a stream is hostile until shown otherwise. The range coder
// makes symbols that cost nothing, so the length of a payload bounds no count by itself.
#pragma once
#include <cstdint>

#include "model/spec.hpp"

namespace sgi {

// Throws Error (limit) if the products of the header's fields are beyond what a tile of these pixels may hold.
void check_model(const ModelSpec &spec, int64_t width, int64_t height);

// The most seeds that a tile may have, given the bytes of its payload.
int64_t max_seeds(const ModelSpec &spec, int64_t width, int64_t height, int64_t payload_bytes);

// Throws Error (limit) for a tile that is too large to have texture.
void check_texture(int channels, int64_t width, int64_t height);

}  // namespace sgi
