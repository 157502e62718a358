// Reads the symbols of a payload group by group (docs/format.md, "Range coder"), and keeps their checksum and what they
// cost. Everything here throws Error (corrupt) where the payload does not decode.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "bitstream/part.hpp"
#include "bitstream/range_decoder.hpp"

namespace sgi {

class SymbolReader {
 public:
  explicit SymbolReader(Bytes payload);

  // Books what is read from now on to a part.
  void begin(Part part) { part_ = part; }

  // `count` equally likely values of at most 32 bits, or one of those.
  std::vector<int32_t> values(int bits, int64_t count);
  int number(int bits) { return values(bits, 1)[0]; }
  // Zero-centred symbols: n under one table, or each under its own.
  std::vector<int32_t> zero_centred(int table, int64_t n);
  void zero_centred(const int16_t *tables, int64_t n, int32_t *symbols);

  // For what reads by itself: it says then what it has read, in coding order, which costs what was decoded since the
  // last time.
  RangeDecoder &decoder() { return decoder_; }
  void record(const int32_t *symbols, int64_t n);

  // The end of the payload: the symbols must be those that were written, and nothing may be left. Without `checked`
  // whatever they are is taken.
  void finish(bool checked = true);

  const std::array<double, kParts> &bits() const { return bits_; }  // information content of each part
  uint32_t crc() const { return crc_; }                             // of all symbols but the check
  int64_t count() const { return count_; }                          // of symbols

 private:
  void note(const int32_t *symbols, int64_t n, double bits);

  RangeDecoder decoder_;
  Part part_ = Part::steps;
  std::array<double, kParts> bits_{};
  double content_ = 0;  // of the decoder when symbols were noted last
  uint32_t crc_ = 0;
  int64_t count_ = 0;
};

}  // namespace sgi
