#include "bitstream/header.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <string>

#include "base/error.hpp"
#include "bitstream/varint.hpp"

namespace sgi {

namespace {

constexpr int kFormatVersion = 7;
constexpr int64_t kMaxFeatures = 1 << 13, kMaxHidden = 1 << 12, kMaxHashLevels = 32, kMaxHashResolution = 1 << 14;
enum Flag : int64_t {
  kSkip = 1,
  kSeedScales = 2,
  kTiled = 4,
  kTransparent = 8,
  kNodata = 16,
  kTexture = 32,
  kLuma = 64,
  kRestoration = 128,
  kRanges = 256,
  kBandMasks = 512,
  kExact = 1024,
  kAllFlags = 2047
};

constexpr const char *kLayouts[] = {"multi", "gray", "gray+alpha", "rgb", "rgba"};
constexpr const char *kSamples[] = {"uint8", "uint16", "float32"};

[[noreturn]] void corrupt(const std::string &text) { throw Error(Fault::corrupt, "header: " + text); }

// A number in six digits, in any locale.
std::string text_of(double value) {
  if (std::isnan(value)) return "nan";
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  for (char *at = text; *at; ++at) *at = *at == ',' ? '.' : *at;  // the decimal point of many languages
  return text;
}

// The fields of a payload, one after the other.
class Fields {
 public:
  explicit Fields(Bytes data) : data_(data) {}

  int64_t take(const std::string &what, int64_t low, int64_t high) {
    if (at_ >= data_.size) corrupt("ends before " + what);
    int64_t value;
    try {
      value = decode_varint(data_, at_);
    } catch (const Error &error) {
      corrupt(what + ": " + error.what());
    }
    if (value < low || value > high)
      throw Error(Fault::limit, "header: " + what + " is " + std::to_string(value) + "; this version takes " +
                                    std::to_string(low) + " to " + std::to_string(high));
    return value;
  }

  template <class T>
  void unpack(const std::string &what, T *values, size_t count) {
    const size_t bytes = count * sizeof(T);
    if (bytes > data_.size - at_) corrupt("ends before " + what);
    std::memcpy(values, data_.data + at_, bytes);
    at_ += bytes;
  }

  bool at_end() const { return at_ == data_.size; }

 private:
  Bytes data_;
  size_t at_ = 0;
};

ContextSpec take_context(Fields &fields) {
  ContextSpec context;
  context.prior = int(fields.take("the prior", 0, 255));
  context.hidden = int(fields.take("the context model's width", 1, kMaxHidden));
  context.neighbours = int(fields.take("the neighbours", 0, 6));
  const int64_t levels = fields.take("the hash levels", 0, kMaxHashLevels);
  for (int64_t i = 0; i < levels; ++i)
    context.hash_resolutions.push_back(int(fields.take("a hash resolution", 1, kMaxHashResolution)));
  if (levels) {
    context.hash_features = int(fields.take("the hash features", 1, 64));
    context.hash_log2_entries = int(fields.take("the hash entries", 1, 20));
  }
  return context;
}

// From the seed layout to the hash entries, into `header`; returns the flags.
int64_t take_model(Fields &fields, Header &header) {
  ModelSpec &spec = header.spec;
  spec.layout = SeedLayoutKind(fields.take("the seed layout", 0, 1));
  spec.shape = ShapeKind(fields.take("the shape", 0, 1));
  const int64_t flags = fields.take("the flags", 0, kAllFlags);
  spec.per_seed = int(fields.take("K", 1, 64));
  spec.features = int(fields.take("D", 1, kMaxFeatures));
  spec.hidden = int(fields.take("the decoders' width", 0, kMaxHidden));
  spec.base_cell = int(fields.take("the base cell", 0, 1 << 12));
  header.quality = int(fields.take("the base step", 0, 255));
  header.family = int(fields.take("the table family", 0, 1));
  spec.context = take_context(fields);
  spec.skip = flags & kSkip, spec.seed_scales = flags & kSeedScales;
  spec.texture = flags & kTexture, spec.luma_space = flags & kLuma;
  spec.restoration = flags & kRestoration;
  const bool other_seeds = spec.skip && (spec.per_seed != 1 || spec.features < spec.channels + 3);
  if (other_seeds || (spec.context.neighbours && !spec.skip)) corrupt("settings that contradict each other");
  return flags;
}

void check_layout(const Header &header) {
  const std::string name = kLayouts[int(header.channels)];
  const bool is_coloured = header.channels == ChannelLayout::rgb || header.channels == ChannelLayout::rgba;
  if (header.spec.luma_space && !is_coloured) corrupt(name + " has no luma space");
  const int given = header.spec.channels;
  const int expected = header.channels == ChannelLayout::multi ? given : int(header.channels);
  if (expected != given) corrupt(std::to_string(given) + " channels cannot be " + name);
}

// One range for all colours, or one for each.
void take_ranges(Fields &fields, int64_t flags, Header &header) {
  const double largest = largest_of(header.sample_type);
  header.low.assign(size_t(header.spec.channels), 0), header.high.assign(size_t(header.spec.channels), largest);
  const bool is_float = header.sample_type == SampleType::f32;
  if (!is_float && !(flags & kRanges)) return;
  const int64_t colours = header.colours(), count = flags & kRanges ? fields.take("the sample ranges", 1, colours) : 1;
  if (count != 1 && count != colours) corrupt("sample ranges of another number of channels");
  if (count == 1 && is_float && (flags & kRanges)) corrupt("a flag for one sample range of floats");
  for (int64_t c = 0; c < count; ++c) {
    float range[2];
    fields.unpack("the sample range", range, 2);
    const double low = range[0], high = range[1];
    const bool is_sound = std::fabs(low) <= kMaxSample && std::fabs(high) <= kMaxSample && low < high;
    const bool fits = is_float || (low >= 0 && high <= largest && low == std::trunc(low) && high == std::trunc(high));
    if (!is_sound || !fits) corrupt("a sample range of " + text_of(low) + " to " + text_of(high));
    for (int64_t at = c; at < (count == 1 ? colours : c + 1); ++at)
      header.low[size_t(at)] = low, header.high[size_t(at)] = high;
  }
}

Masked masked_of(int64_t flags, ChannelLayout channels) {
  const bool has_alpha = channels == ChannelLayout::gray_alpha || channels == ChannelLayout::rgba;
  if ((flags & kTransparent) && (flags & kNodata)) corrupt("pixels are either transparent or without data");
  if ((flags & kTransparent) && !has_alpha)
    corrupt(std::string(kLayouts[int(channels)]) + " has no transparent pixels");
  return flags & kTransparent ? Masked::transparent : flags & kNodata ? Masked::nodata : Masked::none;
}

void check_nodata(const Header &header) {
  if (header.masked != Masked::nodata || header.sample_type == SampleType::f32) return;
  if (!(header.nodata >= 0 && header.nodata <= largest_of(header.sample_type) &&
        header.nodata == std::trunc(header.nodata)))
    corrupt(std::string("no sample of ") + kSamples[int(header.sample_type)] + " is " + text_of(header.nodata));
}

void check_tiles(const Header &header) {
  const int64_t count = header.grid().count();
  if (header.tile && count == 1) corrupt("a picture of one tile states a tile size of " + std::to_string(header.tile));
  if (count > kMaxTiles)
    throw Error(Fault::limit,
                "header: " + std::to_string(count) + " tiles; this version takes at most " + std::to_string(kMaxTiles));
}

}  // namespace

Header decode_header(Bytes payload) {
  Fields fields(payload);
  const int64_t version = fields.take("the format version", 0, 1 << 20);
  if (version != kFormatVersion)
    throw Error(Fault::unsupported, "header: format version " + std::to_string(version) +
                                        "; this program reads version " + std::to_string(kFormatVersion) + " alone");
  Header header{};
  header.width = fields.take("the width", 1, kMaxSide), header.height = fields.take("the height", 1, kMaxSide);
  header.spec.channels = int(fields.take("the number of channels", 1, kMaxChannels));
  header.channels = ChannelLayout(fields.take("the channel layout", 0, int64_t(std::size(kLayouts)) - 1));
  header.sample_type = SampleType(fields.take("the sample type", 0, int64_t(std::size(kSamples)) - 1));
  header.profile = int(fields.take("the profile", 0, 1));
  const int64_t flags = take_model(fields, header);
  check_layout(header);
  header.tile = flags & kTiled ? fields.take("the tile size", kMinTile, kMaxSide) : 0;
  header.apron = flags & kTiled ? fields.take("the apron", 0, std::min(header.tile / 4, kMaxApron)) : 0;
  take_ranges(fields, flags, header);
  header.masked = masked_of(flags, header.channels);
  if (header.masked == Masked::nodata) fields.unpack("the nodata value", &header.nodata, 1);
  header.has_band_masks = flags & kBandMasks, header.has_exact = flags & kExact;
  if (header.has_band_masks && (header.masked != Masked::nodata || header.colours() < 2))
    corrupt("masks of bands without nodata, or of a single band");
  if (!fields.at_end()) corrupt("longer than its fields");
  check_nodata(header);
  check_tiles(header);
  return header;
}

int Header::alpha() const {
  const bool has = channels == ChannelLayout::gray_alpha || channels == ChannelLayout::rgba;
  return has ? spec.channels - 1 : -1;
}

Header Header::of_tile(int64_t number) const {
  const PixelRect rect = grid().rect(number);
  Header one = *this;
  one.width = rect.width, one.height = rect.height, one.tile = 0, one.apron = 0;
  return one;
}

}  // namespace sgi
