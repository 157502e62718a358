#include "bitstream/stream_reader.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "bitstream/chunk_kinds.hpp"
#include "bitstream/container.hpp"
#include "bitstream/index.hpp"
#include "bitstream/tile.hpp"

namespace sgi {

namespace {

constexpr uint64_t kExpected = 1 << 23;  // bytes that a source is told of at a time

[[noreturn]] void corrupt(const std::string &text) { throw Error(Fault::corrupt, text); }

Bytes view(const std::vector<uint8_t> &bytes) { return {bytes.data(), bytes.size()}; }

}  // namespace

struct StreamReader::Parts {
  Parts(std::unique_ptr<ByteSource> source, bool is_overview) : chunks(std::move(source), known_chunks(is_overview)) {
    read();
    size = chunks.size() ? *chunks.size() : chunks.end();
    if (places.empty()) corrupt("there is no tile: nothing to draw");
    const auto is_missing = [](const ChunkPlace &place) { return place.offset < 0; };
    const auto missing = std::count_if(places.begin(), places.end(), is_missing);
    if (missing) {
      const auto first = std::find_if(places.begin(), places.end(), is_missing) - places.begin();
      corrupt(std::to_string(int64_t(places.size()) - missing) + " of " + std::to_string(places.size()) +
              " tiles are there; tile " + std::to_string(first) + " is missing");
    }
  }

  // Whether tiles can be read when they are wanted.
  bool is_lasting() const { return header.tile > 0 && chunks.size(); }

  void read() {
    for (Chunk chunk; chunks.next(chunk);) {
      if (chunk.kind == 'T') {
        if (places.empty() && read_index()) return;
        if (is_lasting()) check_unlisted(header.grid().count());
        note(chunk);
      } else if (chunk.kind == 'X' && header.tile) {
        chunks.check(chunk);
      } else if (is_late(chunk)) {
        corrupt(chunk.name() + ": there may be only one, before the tiles");
      } else if (chunk.kind == 'o') {
        has_overview = true, overview = chunk;
        if (!chunks.size()) kept_overview = chunks.payload(chunk);
      } else if (chunk.kind == 'r') {
        has_residual = true, residual = chunk;
        if (!chunks.size()) kept_residual = chunks.payload(chunk);
      } else {
        blobs[chunk.kind] = chunks.payload(chunk);
        if (chunk.kind == 'H') header = decode_header(view(blobs['H']));
      }
      if (chunk.kind != 'T' && chunk.kind != 'X') count(chunk);
    }
  }

  // Whether it is a second one, or behind a tile of several.
  bool is_late(const Chunk &chunk) const {
    const bool again = chunk.kind == 'X' || chunk_bytes.count({chunk.kind});
    return again || (header.tile && !places.empty());
  }

  void count(const Chunk &chunk) { chunk_bytes[{chunk.kind}] += int64_t(chunk.end() - chunk.offset); }

  // Remembers a tile that was come across.
  void note(const Chunk &chunk) {
    const bool lasting = is_lasting();
    const auto start = lasting ? chunks.peek(chunk.begin(), size_t(std::min<int64_t>(kMaxVarintBytes, chunk.length)))
                               : chunks.payload(chunk);
    const int64_t number = tile_number(header, view(start));
    if (places.empty()) places.assign(size_t(header.grid().count()), {-1, -1});
    ChunkPlace &place = places[size_t(number)];
    if (place.offset >= 0) corrupt(chunk.name() + ": there may be only one tile " + std::to_string(number));
    place = {lasting ? int64_t(chunk.offset) : int64_t(kept.size()), chunk.length};
    if (!lasting) kept.insert(kept.end(), start.begin(), start.end());
    count(chunk);
  }

  // Looks for an index at the end of the file; true if it gives the places of the tiles.
  bool read_index() {
    if (!is_lasting()) return false;
    const uint64_t whole = *chunks.size();
    const auto tail = chunks.peek(whole - std::min<uint64_t>(whole, kTrailerBytes), kTrailerBytes);
    const auto offset = index_offset(view(tail));
    if (!offset || *offset <= kSignatureBytes || *offset >= whole) return false;
    chunks.hold(*offset, whole - *offset);
    const Chunk chunk = chunks.chunk_at(*offset);
    const int64_t tiles = header.grid().count();
    if (chunk.kind != 'X' || chunk.end() != whole - kEndBytes || chunk.length > longest_index(tiles)) return false;
    places = decode_index(view(chunks.payload(chunk)), tiles);
    int64_t first = places[0].offset;
    for (const ChunkPlace &place : places) first = std::min(first, place.offset);
    chunk_bytes["X"] = int64_t(chunk.end() - chunk.offset), chunk_bytes["T"] = int64_t(*offset) - first;
    return true;
  }

  // All that a tile's chunk may take.
  static ByteRange range_of(const ChunkPlace &place) {
    return {uint64_t(place.offset), sizeof Chunk::head + uint64_t(place.length) + kChunkCrcBytes};
  }

  size_t expect(const std::vector<int64_t> &numbers, size_t first) {
    if (!is_lasting()) return numbers.size();
    std::vector<ByteRange> ranges;
    uint64_t bytes = 0;
    for (; first < numbers.size() && bytes < kExpected; ++first) {
      ranges.push_back(range_of(places[size_t(numbers[first])]));
      bytes += ranges.back().count;
    }
    chunks.expect(ranges);
    return first;
  }

  std::vector<uint8_t> tile(int64_t number) {
    const ChunkPlace place = places[size_t(number)];
    if (!is_lasting()) {
      const auto first = kept.begin() + place.offset;
      return {first, first + place.length};
    }
    const ByteRange bytes = range_of(place);
    chunks.hold(bytes.offset, bytes.count);
    const Chunk chunk = chunks.chunk_at(uint64_t(place.offset));
    if (chunk.kind != 'T' || chunk.length != place.length)
      corrupt("index: " + chunk.name() + " is not tile " + std::to_string(number) + "; the file is damaged");
    std::vector<uint8_t> payload = chunks.payload(chunk);
    if (tile_number(header, view(payload)) != number)
      corrupt("index: " + chunk.name() + " is another tile than " + std::to_string(number) + "; the file is damaged");
    return payload;
  }

  ChunkReader chunks;
  Header header{};
  uint64_t size = 0;
  std::map<char, std::vector<uint8_t>> blobs;
  std::map<std::string, int64_t> chunk_bytes{{"signature", kSignatureBytes}};
  std::vector<ChunkPlace> places;  // of each tile, in the file or in `kept`; offset -1 where there is none
  std::vector<uint8_t> kept;       // payloads of a picture in one piece, or of a source without a size
  bool has_overview = false;
  Chunk overview{};
  std::vector<uint8_t> kept_overview;  // of a source without a size
  bool has_residual = false;
  Chunk residual{};
  std::vector<uint8_t> kept_residual;  // the same
};

StreamReader::StreamReader(std::unique_ptr<ByteSource> source, bool is_overview)
    : parts_(std::make_unique<Parts>(std::move(source), is_overview)) {}
StreamReader::~StreamReader() = default;

const Header &StreamReader::header() const { return parts_->header; }
uint64_t StreamReader::size() const { return parts_->size; }
const std::map<char, std::vector<uint8_t>> &StreamReader::blobs() const { return parts_->blobs; }
const std::map<std::string, int64_t> &StreamReader::chunk_bytes() const { return parts_->chunk_bytes; }
bool StreamReader::has_overview() const { return parts_->has_overview; }

std::vector<uint8_t> StreamReader::overview() {
  if (!parts_->has_overview || !parts_->chunks.size()) return parts_->kept_overview;
  return parts_->chunks.payload(parts_->overview);
}

int64_t StreamReader::residual_bytes() const { return parts_->has_residual ? parts_->residual.length : -1; }

void StreamReader::check_residual() {
  if (parts_->has_residual && parts_->chunks.size()) parts_->chunks.check(parts_->residual);  // else that was done
}

std::vector<uint8_t> StreamReader::residual(int64_t offset, int64_t count) {
  const int64_t end = std::min(residual_bytes(), offset + count);
  if (parts_->chunks.size())
    return parts_->chunks.peek(parts_->residual.begin() + uint64_t(offset), size_t(end - offset));
  return {parts_->kept_residual.begin() + offset, parts_->kept_residual.begin() + end};
}

size_t StreamReader::expect(const std::vector<int64_t> &numbers, size_t first) {
  return parts_->expect(numbers, first);
}

std::vector<uint8_t> StreamReader::tile(int64_t number) {
  const int64_t count = int64_t(parts_->places.size());
  if (number < 0 || number >= count)
    throw Error(Fault::region, "tile " + std::to_string(number) + " in a stream of " + std::to_string(count));
  return parts_->tile(number);
}

}  // namespace sgi
