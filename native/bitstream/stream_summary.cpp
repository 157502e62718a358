#include "bitstream/stream_summary.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "bitstream/chunk_kinds.hpp"
#include "bitstream/container.hpp"
#include "bitstream/index.hpp"
#include "bitstream/residual_layer.hpp"

namespace sgi {

namespace {

// Counts all tiles at once, from the first one to the index that the end of the file names, if it does.
bool jump(ChunkReader &chunks, const Chunk &first, std::map<std::string, int64_t> &chunk_bytes) {
  const uint64_t whole = *chunks.size();
  const auto tail = chunks.peek(whole - std::min<uint64_t>(whole, kTrailerBytes), kTrailerBytes);
  const auto offset = index_offset({tail.data(), tail.size()});
  if (!offset || *offset < first.end() || *offset >= whole) return false;
  const Chunk index = chunks.chunk_at(*offset);
  if (index.kind != 'X' || index.end() != whole - kEndBytes) return false;
  chunk_bytes["T"] = int64_t(*offset - first.offset), chunk_bytes["X"] = int64_t(index.end() - index.offset);
  return true;
}

// What a residual layer begins with.
ResidualForm form_of(ChunkReader &chunks, const Header &header, const Chunk &layer) {
  const auto length = size_t(std::min(longest_residual_form(header), layer.length));
  const auto start = chunks.size() ? chunks.peek(layer.begin(), length) : chunks.payload(layer);
  size_t at = 0;
  return read_residual_form(header, {start.data(), start.size()}, at);
}

}  // namespace

StreamSummary summarize(std::unique_ptr<ByteSource> source) {
  ChunkReader chunks(std::move(source), known_chunks());
  StreamSummary found;
  found.chunk_bytes["signature"] = kSignatureBytes;
  for (Chunk chunk; chunks.next(chunk);) {
    if (chunk.kind == 'T' && found.header.tile && chunks.size()) {
      if (jump(chunks, chunk, found.chunk_bytes)) break;
      check_unlisted(found.header.grid().count());
    }
    found.chunk_bytes[{chunk.kind}] += int64_t(chunk.end() - chunk.offset);
    if (chunk.kind == 'r') {
      const ResidualForm form = form_of(chunks, found.header, chunk);
      found.max_error = form.max_error, found.has_exact_views = form.has_views;
      found.has_cells = form.has_cells;
    }
    if (chunk.kind == 'T' || chunk.kind == 'X' || chunk.kind == 'o' || chunk.kind == 'r') continue;
    const auto &payload = found.blobs[chunk.kind] = chunks.payload(chunk);
    if (chunk.kind == 'H') found.header = decode_header({payload.data(), payload.size()});
  }
  found.size = chunks.size() ? *chunks.size() : chunks.end();
  if (!found.chunk_bytes.count("T")) throw Error(Fault::corrupt, "there is no tile: nothing to draw");
  return found;
}

}  // namespace sgi
