// The outer layer of a file: a signature, then chunks (docs/format.md, "File").
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bitstream/byte_source.hpp"
#include "bitstream/varint.hpp"

namespace sgi {

constexpr int kSignatureBytes = 8, kChunkCrcBytes = 4;
constexpr char kSignature[kSignatureBytes + 1] = "\x89SGI\r\n\x1a\n";
constexpr int64_t kMaxPayload = int64_t(1) << 30;

// One chunk of a file that is being read.
struct Chunk {
  char kind;
  uint64_t offset;  // where it starts in the file
  int64_t length;   // bytes of payload
  uint8_t head[1 + kMaxVarintBytes];
  int head_bytes;  // before the payload

  uint64_t begin() const { return offset + uint64_t(head_bytes); }  // of the payload
  uint64_t end() const { return begin() + uint64_t(length) + kChunkCrcBytes; }
  std::string name() const { return std::string("chunk ") + kind + " at byte " + std::to_string(offset); }
};

// The known chunks of a file, from the header to the end mark, which is not among them. Of a source that has a size,
// payloads can be read at any time, else only before the next chunk is asked for. Throws Error: corrupt, unsupported
// for an unknown required chunk, limit for a payload that is too long.
class ChunkReader {
 public:
  // `known`: the letters that the caller understands, besides those of the header and the end mark.
  ChunkReader(std::unique_ptr<ByteSource> source, std::string known);

  bool next(Chunk &chunk);  // false at the end mark
  // Reads these bytes of a source that has a size at once, if they are not many; what is asked for next comes from
  // them.
  void hold(uint64_t offset, uint64_t count);
  // As of the source.
  void expect(const std::vector<ByteRange> &ranges) { source_->expect(ranges); }
  std::optional<uint64_t> size() const { return size_; }
  uint64_t end() const { return next_; }  // behind the last chunk that `next` came across
  // The chunk that begins at an offset of a source that has a size.
  Chunk chunk_at(uint64_t offset);
  // Up to `count` bytes of a source that has a size; they are not checked.
  std::vector<uint8_t> peek(uint64_t offset, size_t count);
  // Checks the CRC.
  std::vector<uint8_t> payload(const Chunk &chunk);
  // Checks the CRC and keeps nothing.
  void check(const Chunk &chunk);

 private:
  void check_signature();
  void finish(const Chunk &last);
  size_t fetch(uint64_t offset, uint8_t *out, size_t count);
  void go_to(uint64_t offset, const std::string &cut, const std::string &where);
  void read(uint8_t *out, size_t count, const std::string &cut);
  template <class Take>
  void read_body(const Chunk &chunk, const Take &take);

  std::unique_ptr<ByteSource> source_;
  const std::string known_;
  std::optional<uint64_t> size_;
  uint64_t position_ = 0, next_ = kSignatureBytes;
  std::vector<uint8_t> held_;
  uint64_t held_from_ = 0;
};

}  // namespace sgi
