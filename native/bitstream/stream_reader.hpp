// The chunks of an opened stream: header and metadata at once, tiles on demand.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bitstream/byte_source.hpp"
#include "bitstream/header.hpp"

namespace sgi {

// Reads all but the tiles. Those are found by the index of a source that has a size, else by reading on; of one that
// has none the compressed tiles are kept. Not safe for use by two threads at once.
class StreamReader {
 public:
  // An overview in an overview is passed over: `is_overview`. Throws Error.
  explicit StreamReader(std::unique_ptr<ByteSource> source, bool is_overview = false);
  ~StreamReader();

  const Header &header() const;
  uint64_t size() const;                                      // of the file, bytes
  const std::map<char, std::vector<uint8_t>> &blobs() const;  // metadata by the letter of their chunk
  const std::map<std::string, int64_t> &chunk_bytes() const;  // by letter, frame included; and the "signature"
  bool has_overview() const;
  std::vector<uint8_t> overview();  // empty where there is none
  int64_t residual_bytes() const;   // of the payload of the residual layer; -1 where there is none
  // Up to `count` bytes of that payload, which are not checked.
  std::vector<uint8_t> residual(int64_t offset, int64_t count);
  // Checks the CRC of the residual layer's chunk, if there is one: what reads a part of the payload cannot.
  void check_residual();
  std::vector<uint8_t> tile(int64_t number);  // the payload of its chunk
  // Tells the source that tiles are read next, those from place `first` on, up to a few megabytes of them. Returns the
  // place behind the last one.
  size_t expect(const std::vector<int64_t> &numbers, size_t first);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sgi
