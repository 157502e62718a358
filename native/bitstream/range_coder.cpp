#include "bitstream/range_coder.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace sgi {

namespace {

constexpr int kPrecision = 24;
constexpr uint64_t kTotal = uint64_t(1) << kPrecision;
constexpr int kPiece = 16;  // bits of a value that are coded at once

double content_of(int64_t bytes, uint64_t range) { return 8 * double(bytes) - std::log2(double(range)); }

}  // namespace

SymbolModels::SymbolModels(const int64_t *frequency, const int64_t *start, int64_t models) {
  first_.push_back(0);
  for (int64_t k = 0; k < models; ++k) {
    uint32_t sum = 0;
    for (int64_t i = start[k]; i < start[k + 1]; ++i) {
      sums_.push_back(sum);
      sum += uint32_t(frequency[i]);
    }
    const auto count = int64_t(sums_.size()) - first_.back();
    sums_.push_back(sum);
    bucket_.push_back(count > kFew ? int64_t(buckets_.size()) : -1);
    if (count > kFew) {
      const uint32_t *sums = sums_.data() + first_.back();
      uint16_t s = 0;
      for (uint32_t bucket = 0; bucket < kBuckets; ++bucket) {
        while (sums[s + 1] <= bucket << kBucketShift) ++s;
        buckets_.push_back(s);
      }
    }
    first_.push_back(int64_t(sums_.size()));
  }
}

void refuse_payload() { throw Error(Fault::corrupt, "entropy: the payload does not decode; it is damaged"); }

RangeDecoder::RangeDecoder(const uint8_t *payload, int64_t bytes) : payload_(payload, payload + bytes) {
  payload_.resize((bytes + 3) / 4 * 4);  // zeros without end
  offset_ = next_word() << 32;
  offset_ |= next_word();
}

uint64_t RangeDecoder::next_word() {
  const int64_t at = at_;
  at_ += 4;
  if (at >= int64_t(payload_.size())) return 0;
  const uint8_t *p = payload_.data() + at;
  return uint64_t(p[0]) << 24 | uint64_t(p[1]) << 16 | uint64_t(p[2]) << 8 | p[3];
}

inline uint32_t RangeDecoder::quantile(uint64_t scale) const {
  const uint64_t quantile = offset_ / scale;
  if (quantile >= kTotal) refuse_payload();
  return uint32_t(quantile);
}

inline void RangeDecoder::take(uint64_t scale, uint32_t before, uint32_t frequency) {
  offset_ -= scale * before;
  range_ = scale * frequency;
  if (range_ >> 32 == 0) {
    range_ <<= 32;
    offset_ = offset_ << 32 | next_word();
  }
}

void RangeDecoder::code(const SymbolModels &models, const int64_t *start, int64_t keys, int32_t *symbols) {
  for (int64_t k = 0; k < keys; ++k) {
    const uint32_t *sums = models.sums(k);
    if (models.bucket_[k] < 0) {  // few symbols: products take less time than a division
      const auto count = int32_t(models.symbols(k));
      for (int64_t i = start[k]; i < start[k + 1]; ++i) {
        const uint64_t scale = range_ >> kPrecision;
        int32_t s = 0;
        while (s < count && offset_ >= scale * sums[s + 1]) ++s;
        if (s == count) refuse_payload();
        take(scale, sums[s], sums[s + 1] - sums[s]);
        symbols[i] = s;
      }
      continue;
    }
    for (int64_t i = start[k]; i < start[k + 1]; ++i) {
      const uint64_t scale = range_ >> kPrecision;
      const uint32_t found = quantile(scale);
      const int32_t s = models.find(models.bucket_[k], sums, found);
      take(scale, sums[s], sums[s + 1] - sums[s]);
      symbols[i] = s;
    }
  }
}

void RangeDecoder::code_uniform(int bits, int64_t count, int32_t *values) {
  if (bits > kPiece) {
    std::vector<int32_t> low(static_cast<size_t>(count));
    code_uniform(bits - kPiece, count, values), code_uniform(kPiece, count, low.data());
    for (int64_t i = 0; i < count; ++i) values[i] = int32_t(uint32_t(values[i]) << kPiece | uint32_t(low[size_t(i)]));
    return;
  }
  if (bits == 0) std::fill(values, values + count, 0), count = 0;
  const int shift = kPrecision - bits;
  for (int64_t i = 0; i < count; ++i) {
    const uint64_t scale = range_ >> kPrecision;
    const uint32_t s = quantile(scale) >> shift;
    take(scale, s << shift, uint32_t(1) << shift);
    values[i] = int32_t(s);
  }
}

double RangeDecoder::content() const { return content_of(at_, range_); }

bool RangeDecoder::maybe_exhausted() const {
  return at_ >= int64_t(payload_.size()) && offset_ < (uint64_t(1) << 33) - 1;
}

void RangeEncoder::code(const SymbolModels &models, const int64_t *start, int64_t keys, const int32_t *symbols) {
  for (int64_t k = 0; k < keys; ++k)
    for (int64_t i = start[k]; i < start[k + 1]; ++i) {
      const uint32_t *const before = models.sums(k) + symbols[i];
      put(before[0], before[1] - before[0]);
    }
}

void RangeEncoder::code_uniform(int bits, int64_t count, const int32_t *values) {
  for (int low = bits > kPiece ? kPiece : 0; low >= 0; low -= kPiece) {  // the high pieces of all, then the low ones
    const int shift = kPrecision - std::min(bits - low, kPiece);
    const uint32_t mask = (uint32_t(1) << (kPrecision - shift)) - 1;
    for (int64_t i = 0; i < count && mask; ++i) put((uint32_t(values[i]) >> low & mask) << shift, uint32_t(1) << shift);
  }
}

double RangeEncoder::content() const { return content_of(4 * int64_t(words_.size() + 2), range_); }

std::vector<uint8_t> RangeEncoder::finish() {
  raise((uint64_t(1) << 32) - 1);
  words_.push_back(uint32_t(lower_ >> 32));
  std::vector<uint8_t> payload;
  for (const uint32_t word : words_)
    for (int shift = 24; shift >= 0; shift -= 8) payload.push_back(uint8_t(word >> shift));
  while (!payload.empty() && payload.back() == 0) payload.pop_back();
  return payload;
}

}  // namespace sgi
