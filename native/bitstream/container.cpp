#include "bitstream/container.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "base/crc32.hpp"
#include "base/error.hpp"

namespace sgi {

namespace {

using namespace std::string_view_literals;

constexpr size_t kBlock = 1 << 20, kStart = 1 << 12;  // read at a time; when a source is opened
constexpr char kHeader = 'H', kEnd = 'E';

struct OtherFormat {
  std::string_view start, name;
};
constexpr OtherFormat kOtherFormats[] = {{"\xff\xd8\xff"sv, "a JPEG file"},
                                         {"\x89PNG\r\n\x1a\n"sv, "a PNG file"},
                                         {"\x01\xda"sv, "a Silicon Graphics image, which shares the extension .sgi"}};
// What a text-mode transfer, a terminal of seven bits or a re-encoding as UTF-8 makes of the signature.
constexpr std::string_view kDamaged[] = {"\x89SGI\n\x1a\n"sv, "\x89SGI\r\r\n\x1a"sv,   "\x89SGI\r\x1a\n"sv,
                                         "\tSGI\r\n\x1a\n"sv, "\xc2\x89SGI\r\n\x1a"sv, "\xef\xbf\xbdSGI"sv};

bool starts(std::string_view text, std::string_view start) { return text.substr(0, start.size()) == start; }
bool is_upper(char letter) { return letter >= 'A' && letter <= 'Z'; }
bool is_letter(char byte) { return is_upper(byte) || (byte >= 'a' && byte <= 'z'); }

[[noreturn]] void corrupt(const std::string &text) { throw Error(Fault::corrupt, text); }

std::string hex(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) {
    if (!text.empty()) text += ' ';
    text += "0123456789abcdef"[uint8_t(byte) >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

std::string cut_inside(const Chunk &chunk) { return "the file ends inside " + chunk.name() + "; it was cut short"; }

}  // namespace

ChunkReader::ChunkReader(std::unique_ptr<ByteSource> source, std::string known)
    : source_(std::move(source)), known_(std::move(known)), size_(source_->size()) {
  if (size_ && *size_ > uint64_t(INT64_MAX)) throw Error(Fault::usage, "a file cannot have 2^63 bytes");
  hold(0, kStart);
  check_signature();
}

void ChunkReader::hold(uint64_t offset, uint64_t count) {
  if (!size_ || offset >= *size_ || count > kBlock) return;
  held_.resize(size_t(std::min(count, *size_ - offset)));
  held_.resize(source_->read(offset, held_.data(), held_.size()));
  held_from_ = offset;
}

size_t ChunkReader::fetch(uint64_t offset, uint8_t *out, size_t count) {
  const bool is_held =
      offset >= held_from_ && offset - held_from_ < held_.size() && count <= held_.size() - size_t(offset - held_from_);
  if (!is_held) return source_->read(offset, out, count);
  std::copy_n(held_.data() + (offset - held_from_), count, out);
  return count;
}

void ChunkReader::check_signature() {
  char bytes[kSignatureBytes];
  const size_t count = fetch(0, reinterpret_cast<uint8_t *>(bytes), sizeof bytes);
  position_ = count;
  const std::string_view head(bytes, count);
  if (head == std::string_view(kSignature, kSignatureBytes)) return;
  if (head.empty()) corrupt("the file is empty");
  if (starts(std::string_view(kSignature, kSignatureBytes), head))
    corrupt("the file ends after " + std::to_string(count) + " bytes; it was cut short");
  for (const auto &[start, name] : kOtherFormats)
    if (starts(head, start)) corrupt("this is " + std::string(name) + ", no stream of this codec; encode it first");
  for (const auto damaged : kDamaged)
    if (starts(head, damaged))
      corrupt("the signature was altered by a transfer in text mode; copy the file in binary mode");
  corrupt("no stream of this codec: it starts with " + hex(head));
}

bool ChunkReader::next(Chunk &chunk) {
  for (;;) {
    chunk = chunk_at(next_);
    if ((chunk.kind == kHeader) != (next_ == kSignatureBytes))
      corrupt(chunk.name() + ": a file starts with its one header; this one is damaged");
    next_ = chunk.end();
    if (chunk.kind == kEnd) {
      finish(chunk);
      return false;
    }
    if (chunk.kind == kHeader || known_.find(chunk.kind) != std::string::npos) return true;
    check(chunk);  // a flipped bit must not turn a known chunk into an unknown one
    if (is_upper(chunk.kind))
      throw Error(Fault::unsupported, chunk.name() + " is required but unknown; decode the file with a newer version");
  }
}

void ChunkReader::finish(const Chunk &last) {
  uint8_t more;
  const std::string text = last.name() + ": there is data behind the end mark; the file is damaged";
  if (last.length) corrupt(text);
  check(last);
  if (fetch(last.end(), &more, 1)) corrupt(text);
}

Chunk ChunkReader::chunk_at(uint64_t offset) {
  const std::string cut = "the file ends at byte " + std::to_string(offset) + " without its end mark; it was cut short";
  go_to(offset, cut, cut);
  Chunk chunk{0, offset, 0, {}, 0};
  // All at once where nothing is lost by reading too many.
  int known = size_ ? int(fetch(offset, chunk.head, sizeof chunk.head)) : 0;
  position_ += uint64_t(known);
  const auto next_byte = [&] {
    if (chunk.head_bytes >= known) read(chunk.head + known++, 1, cut);
    return chunk.head[chunk.head_bytes++];
  };
  chunk.kind = char(next_byte());
  if (!is_letter(chunk.kind)) corrupt("byte " + std::to_string(offset) + " starts no chunk; the file is damaged");
  chunk.length = read_varint(next_byte);
  if (size_ && chunk.end() > *size_) corrupt(cut_inside(chunk));
  return chunk;
}

std::vector<uint8_t> ChunkReader::peek(uint64_t offset, size_t count) {
  std::vector<uint8_t> bytes(count);
  bytes.resize(fetch(offset, bytes.data(), count));
  return bytes;
}

std::vector<uint8_t> ChunkReader::payload(const Chunk &chunk) {
  if (chunk.length > kMaxPayload)
    throw Error(Fault::limit, chunk.name() + " has " + std::to_string(chunk.length) + " bytes; at most " +
                                  std::to_string(kMaxPayload) + " are allowed here");
  std::vector<uint8_t> bytes;
  read_body(chunk, [&](size_t count) {
    bytes.resize(bytes.size() + count);
    return bytes.data() + bytes.size() - count;
  });
  return bytes;
}

void ChunkReader::check(const Chunk &chunk) {
  std::vector<uint8_t> block;
  read_body(chunk, [&](size_t count) {
    block.resize(count);
    return block.data();
  });
}

// The payload in blocks, then the check of its CRC: a lying length cannot make memory be taken. `take` gives the place
// of a block.
template <class Take>
void ChunkReader::read_body(const Chunk &chunk, const Take &take) {
  const std::string cut = cut_inside(chunk);
  go_to(chunk.begin(), cut, chunk.name());
  uint32_t crc = crc32({chunk.head, size_t(chunk.head_bytes)});
  for (int64_t left = chunk.length; left;) {
    const size_t count = size_t(std::min<int64_t>(left, kBlock));
    uint8_t *const block = take(count);
    read(block, count, cut);
    crc = crc32({block, count}, crc);
    left -= int64_t(count);
  }
  uint8_t stored[kChunkCrcBytes];
  read(stored, sizeof stored, cut);
  for (int i = 0; i < kChunkCrcBytes; ++i)
    if (stored[i] != uint8_t(crc >> 8 * i)) corrupt(chunk.name() + ": wrong CRC; the file is damaged");
}

// Reads on to an offset of a source that has no size.
void ChunkReader::go_to(uint64_t offset, const std::string &cut, const std::string &where) {
  if (size_) {
    position_ = offset;
    return;
  }
  if (offset < position_)
    throw Error(Fault::usage, where + " has gone by, and this source cannot seek; read payloads in file order");
  std::vector<uint8_t> passed(size_t(std::min<uint64_t>(offset - position_, kBlock)));
  while (position_ < offset) read(passed.data(), size_t(std::min<uint64_t>(offset - position_, passed.size())), cut);
}

// Exactly `count` bytes; `cut` says what it means if there are fewer.
void ChunkReader::read(uint8_t *out, size_t count, const std::string &cut) {
  const size_t found = fetch(position_, out, count);
  position_ += found;
  if (found < count) corrupt(cut);
}

}  // namespace sgi
