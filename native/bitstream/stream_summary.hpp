// What a stream says before its tiles. No tile is read, nor the overview, nor blocks of the residual layer.
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
  double max_error = -1;                         // that the residual layer states; -1 where there is none
  bool has_exact_views = false;                  // whether it shows every view
  bool has_cells = false;                        // whether it does in some cells alone
  std::map<char, std::vector<uint8_t>> blobs;    // payloads by letter, without T, X, o and r
  std::map<std::string, int64_t> chunk_bytes{};  // by letter, frame included; and the "signature"
};

// A source without a size is read to its end. Throws Error.
StreamSummary summarize(std::unique_ptr<ByteSource> source);

}  // namespace sgi
