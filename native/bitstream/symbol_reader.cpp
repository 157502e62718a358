#include "bitstream/symbol_reader.hpp"

#include <algorithm>
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

// order [n]: positions of the keys 0..count-1, ascending and stable; start [count + 1]: where each key's begin.
void group_by_key(const int16_t *keys, int64_t n, int count, int32_t *order, int64_t *start) {
  std::fill(start, start + count + 1, int64_t(0));
  for (int64_t i = 0; i < n; ++i) ++start[keys[i] + 1];
  for (int key = 0; key < count; ++key) start[key + 1] += start[key];
  std::vector<int64_t> next(start, start + count);
  for (int64_t i = 0; i < n; ++i) order[next[keys[i]]++] = int32_t(i);
}

// Puts indices in coding order back to their positions as zero-centred symbols, index - support of their table. An
// escape, the last of a table's 2 support + 2 indices, becomes support + 1; whether there are any.
bool ungroup_symbols(const int32_t *indices, const int32_t *order, const int16_t *tables, int64_t n,
                     const int32_t *support, int32_t *symbols) {
  bool any = false;
  for (int64_t i = 0; i < n; ++i) {
    const int32_t within = support[tables[order[i]]];
    any |= indices[i] == 2 * within + 1;
    symbols[order[i]] = indices[i] - within;
  }
  return any;
}

// Replaces the symbols at `where`, each one beyond its table's support: exponents, then mantissas by ascending
// exponent, then signs.
void read_escaped(RangeDecoder &decoder, const int16_t *keys, const std::vector<int32_t> &where, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  std::vector<int32_t> exponent(where.size()), magnitude(where.size());
  const int64_t start[2] = {0, int64_t(where.size())};
  decoder.decode(tables.exponents, start, 1, exponent.data());
  for (int e = 0; e < int(tables.exponents.symbols(0)); ++e) {
    std::vector<int32_t> mantissa(size_t(std::count(exponent.begin(), exponent.end(), e)));
    decoder.decode_uniform(e, int64_t(mantissa.size()), mantissa.data());
    auto next = mantissa.begin();
    for (size_t i = 0; i < where.size(); ++i)
      if (exponent[i] == e) magnitude[i] = *next++ + (1 << e) + tables.support[size_t(keys[size_t(where[i])])];
  }
  std::vector<int32_t> sign(where.size());
  decoder.decode_uniform(1, int64_t(sign.size()), sign.data());
  for (size_t i = 0; i < where.size(); ++i) {
    if (magnitude[i] > kMaxMagnitude)
      throw Error(Fault::corrupt,
                  "entropy: a symbol exceeds ±" + std::to_string(kMaxMagnitude) + "; the stream is damaged");
    symbols[where[i]] = sign[i] ? -magnitude[i] : magnitude[i];
  }
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

void SymbolReader::zero_centred(const int16_t *keys, int64_t n, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  const int32_t *support = tables.support.data();
  std::vector<int32_t> order(static_cast<size_t>(n)), indices(static_cast<size_t>(n));
  std::vector<int64_t> start(kTables + 1);
  group_by_key(keys, n, kTables, order.data(), start.data());
  decoder_.decode(tables.models, start.data(), kTables, indices.data());
  if (ungroup_symbols(indices.data(), order.data(), keys, n, support, symbols)) {
    std::vector<int32_t> where;
    for (int64_t i = 0; i < n; ++i)
      if (symbols[i] > support[keys[i]]) where.push_back(int32_t(i));
    read_escaped(decoder_, keys, where, symbols);
  }
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
