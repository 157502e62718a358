// Codes the symbols of a payload group by group (docs/format.md, "Range coder"), and keeps their checksum and what they
// cost. Reading and writing go the same way: a writer codes what it is given, a reader puts what it finds in its place.
// A reader throws Error (corrupt) where the payload does not decode, a writer Error (usage) for what cannot be coded.
#pragma once
#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "base/bytes.hpp"
#include "bitstream/part.hpp"
#include "bitstream/range_coder.hpp"

namespace sgi {

template <class Range>
class SymbolCoder {
 public:
  static constexpr bool kReads = std::is_same_v<Range, RangeDecoder>;

  // Books what is coded from now on to a part.
  void begin(Part part) { part_ = part; }

  // Equally likely values of at most 32 bits, or one.
  void values(int bits, int64_t count, int32_t *values);
  template <class Values>
  void values(int bits, Values &all) {
    values(bits, int64_t(all.size()), all.data());
  }
  template <class Number>
  void number(int bits, Number &number) {
    int32_t value = int32_t(number);
    values(bits, 1, &value);
    number = Number(value);
  }
  // Zero-centred symbols, each under its table.
  void zero_centred(const int16_t *tables, int64_t n, int32_t *symbols);

  // For what codes by itself: it says then what it has coded, in coding order, which costs what the range coder has
  // spent since the last time.
  Range &range() { return range_; }
  void record(const int32_t *symbols, int64_t n);

  const std::array<double, kParts> &bits() const { return bits_; }  // information content of each part
  uint32_t crc() const { return crc_; }                             // of all symbols but the check
  int64_t count() const { return count_; }                          // of symbols

 protected:
  explicit SymbolCoder(Range range) : range_(std::move(range)) {}
  // Codes the check of all symbols, and what it is.
  uint32_t check();

 private:
  void note(const int32_t *symbols, int64_t n, double bits);
  void escaped(const int16_t *tables, const std::vector<int32_t> &where, int32_t *symbols);

  Range range_;
  Part part_ = Part::steps;
  std::array<double, kParts> bits_{};
  double content_ = 0;  // of the range coder when symbols were noted last
  uint32_t crc_ = 0;
  int64_t count_ = 0;
};

extern template class SymbolCoder<RangeDecoder>;
extern template class SymbolCoder<RangeEncoder>;

class SymbolReader : public SymbolCoder<RangeDecoder> {
 public:
  explicit SymbolReader(Bytes payload);

  // The end of the payload: the symbols must be those that were written, and nothing may be left. Without `checked`
  // whatever they are is taken.
  void finish(bool checked = true);
};

class SymbolWriter : public SymbolCoder<RangeEncoder> {
 public:
  SymbolWriter() : SymbolCoder(RangeEncoder()) {}

  // Appends the check of all symbols; the payload.
  std::vector<uint8_t> finish();
};

}  // namespace sgi
