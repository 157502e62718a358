// Limits of a tile, checked before memory or time is spent: a stream is hostile until shown otherwise. The range coder
// makes symbols that cost nothing, so the length of a payload bounds no count by itself.
#pragma once
#include <cstdint>

#include "model/spec.hpp"

namespace sgi {

// Throws Error (limit) if the products of the header's fields are beyond what a tile of these pixels may hold.
void check_model(const ModelSpec &spec, int64_t width, int64_t height);

// The memory that one tile may take while it is decoded, besides some MiB that any may, in bytes.
constexpr int64_t kAnyMemory = INT64_MAX;

// The most seeds that a tile may have, given the bytes of its payload, and what memory is left for it.
int64_t max_seeds(const ModelSpec &spec, int64_t width, int64_t height, int64_t payload_bytes,
                  int64_t memory = kAnyMemory);

// What of the memory is left by a base layer of so many values, which throws Error (limit) if it takes more, and by
// seeds, which `max_seeds` bounds.
int64_t left_by_base(int64_t values, int64_t memory);
int64_t left_by_seeds(const ModelSpec &spec, int64_t count, int64_t memory);

// Throws Error (limit) where the nodes of a tree of seeds would take more than the memory that is left, or than any
// may.
void check_tree(int64_t width, int64_t height, int64_t memory);

// Throws Error (limit) for a tile that is too large to have texture.
void check_texture(int channels, int64_t width, int64_t height, int64_t memory = kAnyMemory);

}  // namespace sgi
