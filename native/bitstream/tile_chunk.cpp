#include <cmath>
#include <cstring>
#include <string>

#include "base/error.hpp"
#include "bitstream/tile.hpp"
#include "bitstream/varint.hpp"

namespace sgi {
namespace {

constexpr int64_t kMaxPlaces = int64_t(1) << 31;  // of samples in a tile that lists some

enum MaskKind { kAllValid, kNoneValid, kSomeValid, kByBand };
enum BandKind { kBandValid, kBandEmpty, kBandMasked, kBandAsBefore };

// Reads the payload of a tile, part after part.
class TileChunkReader {
 public:
  TileChunkReader(const Header &header, Bytes payload) : header_(header), payload_(payload) {
    number_ = header.tile ? varint() : 0;
    const int64_t count = header.grid().count();
    if (number_ >= count)
      throw Error(Fault::corrupt, "tile " + std::to_string(number_) + " in a stream of " + std::to_string(count));
  }

  int64_t number() const { return number_; }

  TileChunk read() {
    TileChunk chunk{number_, false, {}, {}, {}};
    rect_ = header_.grid().rect(number_);
    if (header_.masked != Masked::none) {
      const int64_t kind = varint();
      chunk.is_empty = kind == kNoneValid && at_ == payload_.size;
      if (chunk.is_empty) return chunk;
      if (kind == kSomeValid)
        chunk.masks.push_back({mask(), false});
      else if (kind == kByBand && header_.has_band_masks)
        chunk.masks = band_masks();
      else if (kind != kAllValid)
        refuse("a mask of an unknown kind");
    }
    if (header_.has_exact) chunk.exact = exact_samples();
    chunk.model = payload_.from(at_);
    return chunk;
  }

 private:
  [[noreturn]] void refuse(const char *what) const {
    throw Error(Fault::corrupt, "tile " + std::to_string(number_) + ": " + what + "; the stream is damaged");
  }

  int64_t varint() { return decode_varint(payload_, at_); }

  std::shared_ptr<Mask> mask() {
    const auto length = uint64_t(varint());
    if (length > payload_.size - at_) refuse("ends inside its mask");
    const Bytes bytes{payload_.data + at_, size_t(length)};
    auto mask = std::make_shared<Mask>(Mask::read(bytes, rect_.width, rect_.height));
    if (!mask->is_mixed()) refuse("a mask that says nothing");
    at_ += size_t(length);
    return mask;
  }

  std::vector<BandMask> band_masks() {
    std::vector<BandMask> masks;
    bool differ = false;
    for (int band = 0; band < header_.colours(); ++band) {
      const int64_t kind = varint();
      if (kind > kBandAsBefore || (kind == kBandAsBefore && masks.empty())) refuse("a band's mask of an unknown kind");
      if (kind == kBandAsBefore)
        masks.push_back(masks.back());
      else
        masks.push_back({kind == kBandMasked ? mask() : nullptr, kind == kBandEmpty});
      differ = differ || (band && kind != kBandAsBefore);
    }
    if (!differ) refuse("masks of bands that are all the same");
    return masks;
  }

  std::vector<ExactSample> exact_samples() {
    const int64_t count = varint(), places = rect_.width * rect_.height * header_.colours();
    if (count > int64_t(payload_.size - at_)) refuse("more exact samples than bytes");
    if (count && places > kMaxPlaces) throw Error(Fault::limit, "a tile of exact samples has too many samples");
    std::vector<ExactSample> samples;
    samples.reserve(size_t(count));
    int64_t place = -1;
    for (int64_t i = 0; i < count; ++i) {
      const int64_t gap = varint();
      if (gap >= places - place - 1) refuse("an exact sample outside the tile");
      place += gap + 1;
      samples.push_back({uint32_t(place), value()});
    }
    return samples;
  }

  float value() {
    return with_sample(header_.sample_type, [&](auto value) {
      if (sizeof value > payload_.size - at_) refuse("ends inside its exact samples");
      std::memcpy(&value, payload_.data + at_, sizeof value);
      at_ += sizeof value;
      return float(value);
    });
  }

  const Header &header_;
  Bytes payload_;
  size_t at_ = 0;
  int64_t number_;
  PixelRect rect_{};
};

}  // namespace

int64_t tile_number(const Header &header, Bytes start) { return TileChunkReader(header, start).number(); }

TileChunk decode_tile_chunk(const Header &header, Bytes payload) { return TileChunkReader(header, payload).read(); }

}  // namespace sgi
