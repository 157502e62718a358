#include "bitstream/stream_reader.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "bitstream/chunk_kinds.hpp"
#include "bitstream/tile.hpp"

namespace sgi {

namespace {

constexpr uint64_t kExpected = 1 << 23;  // bytes that a source is told of at a time

[[noreturn]] void corrupt(const std::string &text) { throw Error(Fault::corrupt, text); }

Bytes view(const std::vector<uint8_t> &bytes) { return {bytes.data(), bytes.size()}; }

// All that a tile's chunk may take.
ByteRange range_of(const ChunkPlace &place) {
  return {uint64_t(place.offset), sizeof Chunk::head + uint64_t(place.length) + kChunkCrcBytes};
}

}  // namespace

StreamReader::StreamReader(std::unique_ptr<ByteSource> source, bool is_overview)
    : chunks_(std::move(source), known_chunks(is_overview)) {
  read();
  size_ = chunks_.size() ? *chunks_.size() : chunks_.end();
  if (places_.empty()) corrupt("there is no tile: nothing to draw");
  const auto is_missing = [](const ChunkPlace &place) { return place.offset < 0; };
  const auto missing = std::count_if(places_.begin(), places_.end(), is_missing);
  if (missing) {
    const auto first = std::find_if(places_.begin(), places_.end(), is_missing) - places_.begin();
    corrupt(std::to_string(int64_t(places_.size()) - missing) + " of " + std::to_string(places_.size()) +
            " tiles are there; tile " + std::to_string(first) + " is missing");
  }
}

bool StreamReader::is_lasting() const { return header_.tile > 0 && chunks_.size(); }

void StreamReader::read() {
  for (Chunk chunk; chunks_.next(chunk);) {
    if (chunk.kind == 'T') {
      if (places_.empty() && read_index()) return;
      if (is_lasting()) check_unlisted(header_.grid().count());
      note(chunk);
    } else if (chunk.kind == 'X' && header_.tile) {
      chunks_.check(chunk);
    } else if (is_late(chunk)) {
      corrupt(chunk.name() + ": there may be only one, before the tiles");
    } else if (chunk.kind == 'o') {
      overview_ = later(chunk);
    } else if (chunk.kind == 'r') {
      residual_ = later(chunk);
    } else {
      blobs_[chunk.kind] = chunks_.payload(chunk);
      if (chunk.kind == 'H') header_ = decode_header(view(blobs_['H']));
    }
    if (chunk.kind != 'T' && chunk.kind != 'X') count(chunk);
  }
}

// Whether it is a second one, or behind a tile of several.
bool StreamReader::is_late(const Chunk &chunk) const {
  const bool again = chunk.kind == 'X' || chunk_bytes_.count({chunk.kind});
  return again || (header_.tile && !places_.empty());
}

StreamReader::Later StreamReader::later(const Chunk &chunk) {
  return {chunk, chunks_.size() ? std::vector<uint8_t>() : chunks_.payload(chunk)};
}

void StreamReader::count(const Chunk &chunk) { chunk_bytes_[{chunk.kind}] += int64_t(chunk.end() - chunk.offset); }

// Remembers a tile that was come across.
void StreamReader::note(const Chunk &chunk) {
  const bool lasting = is_lasting();
  const auto start = lasting ? chunks_.peek(chunk.begin(), size_t(std::min<int64_t>(kMaxVarintBytes, chunk.length)))
                             : chunks_.payload(chunk);
  const int64_t number = tile_number(header_, view(start));
  if (places_.empty()) places_.assign(size_t(header_.grid().count()), {-1, -1});
  ChunkPlace &place = places_[size_t(number)];
  if (place.offset >= 0) corrupt(chunk.name() + ": there may be only one tile " + std::to_string(number));
  place = {lasting ? int64_t(chunk.offset) : int64_t(kept_.size()), chunk.length};
  if (!lasting) kept_.insert(kept_.end(), start.begin(), start.end());
  count(chunk);
}

// Looks for an index at the end of the file; true if it gives the places of the tiles.
bool StreamReader::read_index() {
  if (!is_lasting()) return false;
  const uint64_t whole = *chunks_.size();
  const auto tail = chunks_.peek(whole - std::min<uint64_t>(whole, kTrailerBytes), kTrailerBytes);
  const auto offset = index_offset(view(tail));
  if (!offset || *offset <= kSignatureBytes || *offset >= whole) return false;
  chunks_.hold(*offset, whole - *offset);
  const Chunk chunk = chunks_.chunk_at(*offset);
  const int64_t tiles = header_.grid().count();
  if (chunk.kind != 'X' || chunk.end() != whole - kEndBytes || chunk.length > longest_index(tiles)) return false;
  places_ = decode_index(view(chunks_.payload(chunk)), tiles);
  int64_t first = places_[0].offset;
  for (const ChunkPlace &place : places_) first = std::min(first, place.offset);
  chunk_bytes_["X"] = int64_t(chunk.end() - chunk.offset), chunk_bytes_["T"] = int64_t(*offset) - first;
  return true;
}

std::vector<uint8_t> StreamReader::overview() {
  return chunks_.size() ? chunks_.payload(overview_->chunk) : overview_->kept;
}

void StreamReader::check_residual() {
  if (residual_ && chunks_.size()) chunks_.check(residual_->chunk);  // else that was done
}

std::vector<uint8_t> StreamReader::residual(int64_t offset, int64_t count) {
  const int64_t end = std::min(residual_bytes(), offset + count);
  if (chunks_.size()) return chunks_.peek(residual_->chunk.begin() + uint64_t(offset), size_t(end - offset));
  return {residual_->kept.begin() + offset, residual_->kept.begin() + end};
}

size_t StreamReader::expect(const std::vector<int64_t> &numbers, size_t first) {
  if (!is_lasting()) return numbers.size();
  std::vector<ByteRange> ranges;
  uint64_t bytes = 0;
  for (; first < numbers.size() && bytes < kExpected; ++first) {
    ranges.push_back(range_of(places_[size_t(numbers[first])]));
    bytes += ranges.back().count;
  }
  chunks_.expect(ranges);
  return first;
}

std::vector<uint8_t> StreamReader::tile(int64_t number) {
  const int64_t count = int64_t(places_.size());
  if (number < 0 || number >= count)
    throw Error(Fault::region, "tile " + std::to_string(number) + " in a stream of " + std::to_string(count));
  const ChunkPlace place = places_[size_t(number)];
  if (!is_lasting()) {
    const auto first = kept_.begin() + place.offset;
    return {first, first + place.length};
  }
  const ByteRange bytes = range_of(place);
  chunks_.hold(bytes.offset, bytes.count);
  const Chunk chunk = chunks_.chunk_at(uint64_t(place.offset));
  if (chunk.kind != 'T' || chunk.length != place.length)
    corrupt("index: " + chunk.name() + " is not tile " + std::to_string(number) + "; the file is damaged");
  std::vector<uint8_t> payload = chunks_.payload(chunk);
  if (tile_number(header_, view(payload)) != number)
    corrupt("index: " + chunk.name() + " is another tile than " + std::to_string(number) + "; the file is damaged");
  return payload;
}

}  // namespace sgi
