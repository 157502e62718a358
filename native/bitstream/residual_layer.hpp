// The residual layer of a stream: what its pixels lack to be the source's, or near them (docs/format.md, "Residual
// layer").
#pragma once
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "base/isa.hpp"
#include "bitstream/bits.hpp"
#include "bitstream/header.hpp"
#include "bitstream/residual_coding.hpp"

namespace sgi {

constexpr int64_t kResidualBlock = 512;  // pixels of a side; the last of a row or column may have fewer
constexpr int64_t kResidualCell = 16;    // the same of cells, in a block

// What the layer of a picture begins with.
struct ResidualTable {
  struct Block {
    int64_t offset, bytes;  // in the payload of the chunk; no bytes: nothing of it is coded
    uint32_t crc;           // of its samples, each as a little-endian float
  };
  ResidualForm form;
  std::vector<Block> blocks;  // in rows from the top down
};

// Blocks that a row of them has, for a picture of this width; the same down.
inline int64_t residual_blocks(int64_t side) { return (side + kResidualBlock - 1) / kResidualBlock; }
// The most bytes that the form and the table of a picture take, with tables of samples or without.
int64_t longest_residual_table(const Header &header, bool has_tables);
// Reads the table from the first bytes of a payload of `length` bytes. Throws Error (corrupt).
ResidualTable read_residual_table(const Header &header, Bytes start, int64_t length);

// Reads what a layer states of all its blocks; `at` moves behind it. Throws Error (corrupt).
ResidualForm read_residual_form(const Header &header, Bytes start, size_t &at);

// A block: what all state, its size, and its samples [height, width, channels], of the channels that are coded, as the
// rest of the stream draws them; of alpha alone, zeros.
struct ResidualBlock {
  const Header &header;
  const ResidualForm &form;
  int64_t width, height;
  const float *drawn;

  size_t samples() const { return size_t(width * height) * form.grids.size(); }
  int64_t cells_across() const { return (width + kResidualCell - 1) / kResidualCell; }
  size_t cells() const { return size_t(cells_across() * ((height + kResidualCell - 1) / kResidualCell)); }
};

// The samples of a block as they come out, and which of its cells are coded.
struct ResidualSamples {
  std::vector<float> samples;
  std::vector<uint8_t> cells;
};

// Codes the samples of a block, and leaves in `given` what a reader finds.
void encode_residual(const ResidualBlock &block, Isa isa, ResidualSamples &given, RangeEncoder &encoder);
// Decodes the samples of a block from its bytes. Throws Error (corrupt).
ResidualSamples decode_residual(const ResidualBlock &block, Isa isa, Bytes bytes, uint32_t crc);

}  // namespace sgi
