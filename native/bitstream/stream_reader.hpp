// The chunks of an opened stream: header and metadata at once, tiles on demand.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "bitstream/header.hpp"

namespace sgi {

// What gives the bytes of a file. Throws Error (source) where it fails.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Bytes of the whole, or none for one that can only be read once from its start.
  virtual std::optional<uint64_t> size() = 0;
  // Reads up to `count` bytes from `offset` on; fewer only at the end. Without a size, offsets never go back.
  virtual size_t read(uint64_t offset, uint8_t *out, size_t count) = 0;
};

// Bytes in memory, which must outlive it.
std::unique_ptr<ByteSource> memory_source(Bytes bytes);

// Reads all but the tiles. Those are found by the index of a source that has a size, else by reading on; of one that
// has none the compressed tiles are kept. Not safe for use by two threads at once.
class StreamReader {
 public:
  // An overview in an overview is passed over: `is_overview`. Throws Error.
  explicit StreamReader(std::unique_ptr<ByteSource> source, bool is_overview = false);
  ~StreamReader();

  const Header &header() const;
  uint64_t size() const;                                       // of the file, bytes
  const std::map<char, std::vector<uint8_t>> &blobs() const;   // metadata by the letter of their chunk
  const std::map<std::string, uint64_t> &chunk_bytes() const;  // by letter, frame included; and the "signature"
  bool has_overview() const;
  std::vector<uint8_t> overview();            // empty where there is none
  std::vector<uint8_t> tile(int64_t number);  // the payload of its chunk

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sgi
