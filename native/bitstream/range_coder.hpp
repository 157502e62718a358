// The range coder of docs/format.md, "Range coder": 32-bit words, 64-bit state, 24-bit probabilities.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sgi {

// Frequencies of the symbols of several models, each summing to 2^24, as what finds a symbol fast.
class SymbolModels {
 public:
  // frequency: of all models side by side, model k from start[k] to start[k + 1]; none is 0.
  SymbolModels(const int64_t *frequency, const int64_t *start, int64_t models);

  // Symbols that a model has, and [symbols + 1] the sums of the frequencies before each.
  int64_t symbols(int64_t model) const { return first_[std::size_t(model) + 1] - first_[std::size_t(model)] - 1; }
  const uint32_t *sums(int64_t model) const { return sums_.data() + first_[std::size_t(model)]; }

 private:
  friend class RangeDecoder;

  int32_t find(int64_t bucket, const uint32_t *sums, uint32_t quantile) const {
    int32_t s = buckets_[bucket + (quantile >> kBucketShift)];
    while (sums[s + 1] <= quantile) ++s;
    return s;
  }

  static constexpr int kBucketShift = 16, kBuckets = 1 << 8, kFew = 8;

  std::vector<uint32_t> sums_;
  std::vector<int64_t> first_;     // [models + 1]
  std::vector<int64_t> bucket_;    // [models] where its buckets begin, -1 for a model of few symbols
  std::vector<uint16_t> buckets_;  // the symbol at the first quantile of each bucket
};

// Throws Error (corrupt): the payload does not decode.
[[noreturn]] void refuse_payload();

// Whatever decodes throws Error (corrupt) where the payload does not.
class RangeDecoder {
 public:
  RangeDecoder(const uint8_t *payload, int64_t bytes);

  // Symbols start[k] … start[k + 1] - 1 under model k, k = 0 … keys - 1.
  void code(const SymbolModels &models, const int64_t *start, int64_t keys, int32_t *symbols);

  // Equally likely values of at most 32 bits, of which 0 stand for nothing. Those of more than 16 are coded in two
  // pieces, the high one of all first.
  void code_uniform(int bits, int64_t count, int32_t *values);

  // A bit that is 1 with a probability of one / 2^16, 0 < one < 2^16.
  void code(int32_t one, int &bit) {
    const uint64_t scale = range_ >> 24, zero = uint64_t((1 << 16) - one) << 8, split = scale * zero;
    bit = offset_ >= split;
    if (bit) offset_ -= split;
    range_ = bit ? scale * (uint64_t(one) << 8) : split;
    if (offset_ >= range_) refuse_payload();
    if (range_ >> 32 == 0) {
      range_ <<= 32;
      offset_ = offset_ << 32 | next_word();
    }
  }

  // Information content of all that was decoded, in bits: how far the interval has shrunk.
  double content() const;
  // Whether an encoder may have ended here: nothing is left over.
  bool maybe_exhausted() const;

 private:
  uint64_t next_word();
  uint32_t quantile(uint64_t scale) const;
  void take(uint64_t scale, uint32_t before, uint32_t frequency);

  std::vector<uint8_t> payload_;
  int64_t at_ = 0;  // also behind the end, where zeros are read
  uint64_t range_ = ~uint64_t(0), offset_ = 0;
};

// The other direction: what a RangeDecoder finds in its payload is what it was given, in the same order.
class RangeEncoder {
 public:
  void code(const SymbolModels &models, const int64_t *start, int64_t keys, const int32_t *symbols);
  void code_uniform(int bits, int64_t count, const int32_t *values);
  void code(int32_t one, int bit) {
    const uint32_t zero = uint32_t((1 << 16) - one) << 8;
    put(bit ? zero : 0, bit ? uint32_t(one) << 8 : zero);
  }

  double content() const;
  // The payload. Zero bytes at its end say nothing, and are left out.
  std::vector<uint8_t> finish();

 private:
  void put(uint32_t before, uint32_t frequency) {
    const uint64_t scale = range_ >> 24;
    raise(scale * before);
    range_ = scale * frequency;
    if (range_ >> 32 == 0) {
      words_.push_back(uint32_t(lower_ >> 32));
      lower_ <<= 32, range_ <<= 32;
    }
  }
  // Moves the lower end of the interval, which may carry into words that are there.
  void raise(uint64_t by) {
    lower_ += by;
    if (lower_ >= by) return;
    for (auto word = words_.rbegin(); ++*word == 0;) ++word;
  }

  std::vector<uint32_t> words_;
  uint64_t range_ = ~uint64_t(0), lower_ = 0;
};

}  // namespace sgi
