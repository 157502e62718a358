// Chunk X, the index: the place of each tile in the file. A reader finds it from the end.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "base/bytes.hpp"

namespace sgi {

constexpr int kEndBytes = 6, kTrailerBytes = 18;  // of chunk E; of what a file with an index ends in

// Where a chunk begins in the file, and the length of its payload.
struct ChunkPlace {
  int64_t offset, length;
};

// The places of `count` tiles. Throws Error (corrupt).
std::vector<ChunkPlace> decode_index(Bytes payload, int64_t count);

// Throws Error (limit) if n tiles are too many for a file without an index.
void check_unlisted(int64_t count);

// Bytes that the payload of an index of n tiles cannot exceed.
int64_t longest_index(int64_t count);

// Where the index of a file that ends in these bytes begins, if it has one.
std::optional<uint64_t> index_offset(Bytes tail);

}  // namespace sgi
