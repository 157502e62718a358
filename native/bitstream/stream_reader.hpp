// The chunks of an opened stream: header and metadata at once, tiles on demand.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bitstream/byte_source.hpp"
#include "bitstream/container.hpp"
#include "bitstream/header.hpp"
#include "bitstream/index.hpp"

namespace sgi {

// Reads all but the tiles. Those are found by the index of a source that has a size, else by reading on; of one that
// has none the compressed tiles are kept. Not safe for use by two threads at once.
class StreamReader {
 public:
  // An overview in an overview is passed over: `is_overview`. Throws Error.
  explicit StreamReader(std::unique_ptr<ByteSource> source, bool is_overview = false);

  const Header &header() const { return header_; }
  uint64_t size() const { return size_; }                                       // of the file, bytes
  const std::map<char, std::vector<uint8_t>> &blobs() const { return blobs_; }  // metadata by the letter of their chunk
  // By letter, frame included; and the "signature".
  const std::map<std::string, int64_t> &chunk_bytes() const { return chunk_bytes_; }
  bool has_overview() const { return overview_.has_value(); }
  std::vector<uint8_t> overview();  // where there is one
  // Of the payload of the residual layer; -1 where there is none.
  int64_t residual_bytes() const { return residual_ ? residual_->chunk.length : -1; }
  // Up to `count` bytes of that payload, which are not checked.
  std::vector<uint8_t> residual(int64_t offset, int64_t count);
  // Checks the CRC of the residual layer's chunk, if there is one: what reads a part of the payload cannot.
  void check_residual();
  std::vector<uint8_t> tile(int64_t number);  // the payload of its chunk
  // Tells the source that tiles are read next, those from place `first` on, up to a few megabytes of them. Returns the
  // place behind the last one.
  size_t expect(const std::vector<int64_t> &numbers, size_t first);

 private:
  // One that is read when it is asked for.
  struct Later {
    Chunk chunk;
    std::vector<uint8_t> kept;  // its payload, of a source without a size
  };

  bool is_lasting() const;  // whether tiles can be read when they are wanted
  void read();
  bool read_index();
  void note(const Chunk &chunk);
  bool is_late(const Chunk &chunk) const;
  void count(const Chunk &chunk);
  Later later(const Chunk &chunk);

  ChunkReader chunks_;
  Header header_{};
  uint64_t size_ = 0;
  std::map<char, std::vector<uint8_t>> blobs_;
  std::map<std::string, int64_t> chunk_bytes_{{"signature", kSignatureBytes}};
  std::vector<ChunkPlace> places_;  // of each tile, in the file or in `kept_`; offset -1 where there is none
  std::vector<uint8_t> kept_;       // payloads of a picture in one piece, or of a source without a size
  std::optional<Later> overview_, residual_;
};

}  // namespace sgi
