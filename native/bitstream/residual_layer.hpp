// The residual layer of a stream: what its pixels lack to be the source's, or near them (docs/format.md, "Residual
// layer").
#pragma once
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "base/isa.hpp"
#include "bitstream/header.hpp"
#include "bitstream/residual_coding.hpp"
#include "bitstream/texture_bits.hpp"

namespace sgi {

constexpr int64_t kResidualBlock = 512;  // pixels of a side; the last of a row or column may have fewer

// What the layer of a picture begins with.
struct ResidualTable {
  struct Block {
    int64_t offset, bytes;  // in the payload of the chunk
    uint32_t crc;           // of its samples, each as little-endian uint16
  };
  int32_t max_error;          // of any sample but alpha, which is exact
  std::vector<Block> blocks;  // in rows from the top down
};

// Blocks that a row of them has, for a picture of this width; the same down.
inline int64_t residual_blocks(int64_t side) { return (side + kResidualBlock - 1) / kResidualBlock; }
// The most bytes that the table of a picture takes.
int64_t longest_residual_table(const Header &header);
// Reads the table from the first bytes of a payload of `length` bytes. Throws Error (corrupt).
ResidualTable read_residual_table(const Header &header, Bytes start, int64_t length);

// That of a block of `width` by `height` pixels.
ResidualShape residual_shape(const Header &header, int64_t width, int64_t height, int32_t max_error);
// Notes the bits of samples [height, width, channels] of a block, and leaves in `samples` what a reader finds.
void record_residual(const ResidualShape &shape, Isa isa, const uint16_t *drawn, uint16_t *samples, BitRecorder &bits);
// Decodes samples [height, width, channels] of a block from its bytes and what the rest of the stream draws there.
// Throws Error (corrupt).
void decode_residual(const ResidualShape &shape, Isa isa, Bytes bytes, uint32_t crc, const uint16_t *drawn,
                     uint16_t *samples);

}  // namespace sgi
