#include "bitstream/symbol_reader.hpp"

#include <cstdio>
#include <string>

#include "base/crc32.hpp"
#include "base/error.hpp"
#include "bitstream/frequency_tables.hpp"

namespace sgi {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the checksum takes symbols as they lie in memory");

RangeDecoder decoder_of(Bytes payload) {
  if (payload.size && payload.data[payload.size - 1] == 0)
    throw Error(Fault::corrupt, "entropy: the payload is padded with zero bytes; it was not written by an encoder");
  return {payload.data, int64_t(payload.size)};
}

std::string hexadecimal(uint32_t value) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x", unsigned(value));
  return text;
}

}  // namespace

SymbolReader::SymbolReader(Bytes payload) : decoder_(decoder_of(payload)) {}

std::vector<int32_t> SymbolReader::values(int bits, int64_t count) {
  std::vector<int32_t> found(static_cast<size_t>(count));
  decoder_.decode_uniform(bits, count, found.data());
  note(found.data(), count, double(bits) * double(count));
  return found;
}

std::vector<int32_t> SymbolReader::zero_centred(int table, int64_t n) {
  const std::vector<int16_t> tables(static_cast<size_t>(n), int16_t(table));
  std::vector<int32_t> symbols(static_cast<size_t>(n));
  zero_centred(tables.data(), n, symbols.data());
  return symbols;
}

void SymbolReader::zero_centred(const int16_t *tables, int64_t n, int32_t *symbols) {
  read_zero_centred(decoder_, tables, n, symbols);
  record(symbols, n);
}

void SymbolReader::record(const int32_t *symbols, int64_t n) { note(symbols, n, decoder_.content() - content_); }

void SymbolReader::note(const int32_t *symbols, int64_t n, double bits) {
  crc_ = crc32({reinterpret_cast<const uint8_t *>(symbols), 4 * size_t(n)}, crc_);
  count_ += n;
  bits_[size_t(part_)] += bits;
  content_ = decoder_.content();
}

void SymbolReader::finish(bool checked) {
  if (!checked) return;
  begin(Part::check);
  const uint32_t crc = crc_, written = uint32_t(number(32));
  crc_ = crc;  // of the symbols, not of their check
  if (written != crc_)
    throw Error(Fault::corrupt, "entropy: decoded symbols have CRC " + hexadecimal(crc_) + ", the encoder's had " +
                                    hexadecimal(written) +
                                    "; the payload is damaged, or decoder and encoder disagree about contexts");
  if (!decoder_.maybe_exhausted()) throw Error(Fault::corrupt, "entropy: bytes are left over behind the last symbol");
}

}  // namespace sgi
