#include "bitstream/symbol_coder.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
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

// Throws unless the magnitude of a symbol, from which sums of symbols stay far from overflow, is one of the format's.
void require_magnitude(int64_t magnitude, Fault fault, const char *what) {
  if (magnitude > kMaxMagnitude)
    throw Error(fault, "entropy: a symbol exceeds ±" + std::to_string(kMaxMagnitude) + "; " + what);
}

}  // namespace

template <class Range>
void SymbolCoder<Range>::values(int bits, int64_t count, int32_t *values) {
  if (!kReads && bits < 32 &&
      std::any_of(values, values + count, [&](int32_t value) { return uint32_t(value) >> bits; }))
    throw Error(Fault::usage, "entropy: a value does not fit into " + std::to_string(bits) + " bits");
  range_.code_uniform(bits, count, values);
  note(values, count, double(bits) * double(count));
}

// Indices of symbols go from 0 to 2 support of their table; the next one stands for all symbols beyond.
template <class Range>
void SymbolCoder<Range>::zero_centred(const int16_t *keys, int64_t n, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  const int32_t *const supports = tables.support.data();
  std::vector<int32_t> order(static_cast<size_t>(n)), indices(static_cast<size_t>(n)), beyond;
  std::vector<int64_t> start(kTables + 1);
  group_by_key(keys, n, kTables, order.data(), start.data());
  for (int64_t i = 0; i < n && !kReads; ++i) {
    const int32_t symbol = symbols[order[i]], support = supports[keys[order[i]]];
    require_magnitude(std::abs(int64_t(symbol)), Fault::usage, "use a larger step");
    indices[size_t(i)] = std::abs(symbol) > support ? 2 * support + 1 : symbol + support;
  }
  range_.code(tables.models, start.data(), kTables, indices.data());
  bool any = false;
  for (int64_t i = 0; i < n; ++i) {
    const int32_t support = supports[keys[order[i]]];
    any |= indices[size_t(i)] == 2 * support + 1;
    if (kReads) symbols[order[i]] = indices[size_t(i)] - support;
  }
  for (int64_t i = 0; i < n && any; ++i)
    if (std::abs(symbols[i]) > supports[keys[i]]) beyond.push_back(int32_t(i));
  if (any) escaped(keys, beyond, symbols);
  record(symbols, n);
}

// Symbols at `where`, each one beyond its table's support: exponents, then mantissas by ascending exponent, then signs.
template <class Range>
void SymbolCoder<Range>::escaped(const int16_t *keys, const std::vector<int32_t> &where, int32_t *symbols) {
  const FrequencyTables &tables = frequency_tables();
  std::vector<int32_t> exponent, excess, sign;
  for (const int32_t at : where) {
    excess.push_back(std::abs(symbols[at]) - tables.support[size_t(keys[at])]);
    exponent.push_back(31 - __builtin_clz(unsigned(excess.back())));
    sign.push_back(symbols[at] < 0);
  }
  const int64_t start[2] = {0, int64_t(where.size())};
  range_.code(tables.exponents, start, 1, exponent.data());
  for (int e = 0; e < int(tables.exponents.symbols(0)); ++e) {
    std::vector<int32_t> mantissa;
    for (size_t i = 0; i < where.size(); ++i)
      if (exponent[i] == e) mantissa.push_back(excess[i] - (1 << e));
    range_.code_uniform(e, int64_t(mantissa.size()), mantissa.data());
    auto next = mantissa.begin();
    for (size_t i = 0; i < where.size(); ++i)
      if (exponent[i] == e) excess[i] = *next++ + (1 << e);
  }
  range_.code_uniform(1, int64_t(sign.size()), sign.data());
  for (size_t i = 0; i < where.size(); ++i) {
    const int32_t magnitude = excess[i] + tables.support[size_t(keys[where[i]])];
    require_magnitude(magnitude, Fault::corrupt, "the stream is damaged");
    symbols[where[i]] = sign[i] ? -magnitude : magnitude;
  }
}

template <class Range>
void SymbolCoder<Range>::record(const int32_t *symbols, int64_t n) {
  note(symbols, n, range_.content() - content_);
}

template <class Range>
void SymbolCoder<Range>::note(const int32_t *symbols, int64_t n, double bits) {
  crc_ = crc32({reinterpret_cast<const uint8_t *>(symbols), 4 * size_t(n)}, crc_);
  count_ += n;
  bits_[size_t(part_)] += bits;
  content_ = range_.content();
}

template <class Range>
uint32_t SymbolCoder<Range>::check() {
  begin(Part::check);
  const uint32_t crc = crc_;
  uint32_t coded = crc;
  number(32, coded);
  crc_ = crc;  // of the symbols, not of their check
  return coded;
}

template class SymbolCoder<RangeDecoder>;
template class SymbolCoder<RangeEncoder>;

SymbolReader::SymbolReader(Bytes payload) : SymbolCoder(decoder_of(payload)) {}

void SymbolReader::finish(bool checked) {
  if (!checked) return;
  const uint32_t written = check();
  if (written != crc())
    throw Error(Fault::corrupt, "entropy: decoded symbols have CRC " + hexadecimal(crc()) + ", the encoder's had " +
                                    hexadecimal(written) +
                                    "; the payload is damaged, or decoder and encoder disagree about contexts");
  if (!range().maybe_exhausted()) throw Error(Fault::corrupt, "entropy: bytes are left over behind the last symbol");
}

std::vector<uint8_t> SymbolWriter::finish() {
  check();
  return range().finish();
}

}  // namespace sgi
