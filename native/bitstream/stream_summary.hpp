// What a stream says before its tiles. No tile is read, nor the overview.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bitstream/byte_source.hpp"
#include "bitstream/header.hpp"

namespace sgi {

struct StreamSummary {
  Header header{};
  uint64_t size = 0;                             // of the file, bytes
  std::map<char, std::vector<uint8_t>> blobs;    // payloads by letter, without T, X and o
  std::map<std::string, int64_t> chunk_bytes{};  // by letter, frame included; and the "signature"
};

// A source without a size is read to its end. Throws Error.
StreamSummary summarize(std::unique_ptr<ByteSource> source);

}  // namespace sgi
