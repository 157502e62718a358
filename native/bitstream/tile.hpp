// A tile: its chunk, and the model in it, coded part by part (docs/format.md, "Tiles" and "Tile parts").
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "base/bytes.hpp"
#include "base/isa.hpp"
#include "bitstream/header.hpp"
#include "bitstream/limits.hpp"
#include "bitstream/mask.hpp"
#include "bitstream/part.hpp"
#include "bitstream/restoration_part.hpp"
#include "bitstream/shipped_networks.hpp"
#include "bitstream/symbol_coder.hpp"
#include "bitstream/texture_part.hpp"
#include "model/step_plan.hpp"

namespace sgi {

// MLP_c or MLP_Sigma in units of 2^-shift; empty where there is none.
struct AttributeDecoder {
  std::vector<int64_t> w1, b1, w2, b2;  // [w, D], [w], [O, w], [O]
  int shift = 0;
};

// What a tile was coded with: an encoder that writes it again needs it, what draws does not.
struct TileCoding {
  std::vector<GroupSteps> plan;  // groups in coding order
  Networks networks;             // by coding step
  std::vector<uint8_t> signs;    // of the hash grid, 0 or 1
  std::optional<CodedTexture> texture;
};

// What is known when a payload is read.
struct TileEnd {
  std::array<double, kParts> bits{};  // information content of each part
  uint32_t symbol_crc = 0;            // CRC-32 of all symbols: equal on every machine
};

// A decoded model.
struct TileModel {
  std::vector<int32_t> corner;   // [N, 2] pixels
  std::vector<int8_t> log_size;  // [N]
  std::vector<int64_t> decoded;  // [N, d_A] attributes in units of 2^-24
  std::vector<int64_t> base;     // [C, rows, columns] in steps of index `base_step`
  int base_step = 0;
  AttributeDecoder colours, shapes;
  RestorationChoice restoration;
  TileCoding coding;
  TileEnd end;

  int64_t seeds() const { return int64_t(log_size.size()); }
};

// How a payload is read, or written.
struct TileReading {
  int threads = 1;
  Isa isa = Isa::portable;
  bool checked = true;          // false: the checksum of symbols is not compared; for tests, which forge payloads
  int64_t memory = kAnyMemory;  // bytes that the tile may take, besides some MiB
};

// Reads a payload part by part. Throws Error: corrupt where the symbols are not those that were written, limit before
// it takes memory for a model beyond the caps.
class TileReader {
 public:
  // header: the tile's own (Header::of_tile). It and the payload must outlive the reader.
  TileReader(const Header &header, Bytes payload, const TileReading &how);

  // First all but texture and `end`.
  TileModel model();
  // Then texture, where there is some: its symbols, or what draws it.
  bool has_texture() const { return texture_.has_value(); }
  CodedTexture texture();
  void texture_cells(TextureCells &cells, const TextureRows &rows_read);
  // Then the end of the payload: nothing may be left.
  TileEnd finish();

 private:
  const Header &header_;
  const TileReading how_;
  SymbolReader reader_;
  const int64_t payload_bytes_;
  std::optional<TextureIndices> texture_;
};

// All of it at once.
TileModel read_tile(const Header &header, Bytes payload, const TileReading &how);

// The payload of a model whose attributes are to be `values` [N, d_A], as near as its steps allow; `end` becomes what a
// reader will know. Throws Error: limit for a model that a reader would refuse, usage for one that cannot be coded.
std::vector<uint8_t> write_tile(const Header &header, TileModel &model, const double *values, const TileReading &how);

// Which pixels of a band hold nothing: those of its mask, without one all or none.
struct BandMask {
  std::shared_ptr<Mask> pixels;
  bool is_all = false;
};

// A sample that is stated exactly: the row, column and band in a tile as (row * width + column) * colours + band.
struct ExactSample {
  uint32_t place;
  float value;  // also holds integers of 16 bits
};

// The payload of a chunk T.
struct TileChunk {
  int64_t number;
  bool is_empty;                   // no pixel holds anything: there is no model
  std::vector<BandMask> masks;     // one for all bands, or one for each colour; none where all pixels hold something
  std::vector<ExactSample> exact;  // by ascending place
  Bytes model;                     // part of the payload that was given
};
TileChunk decode_tile_chunk(const Header &header, Bytes payload);
// The number of the tile whose payload begins so.
int64_t tile_number(const Header &header, Bytes start);

}  // namespace sgi
