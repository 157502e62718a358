#include "bitstream/header.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>

#include "base/error.hpp"
#include "bitstream/header_fields.hpp"
#include "bitstream/varint.hpp"
#include "model/restoration_network.hpp"

namespace sgi {

namespace {

[[noreturn]] void corrupt(const std::string &text) { throw Error(Fault::corrupt, "header: " + text); }

// A number in six digits, in any locale.
std::string text_of(double value) {
  if (std::isnan(value)) return "nan";
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  for (char *at = text; *at; ++at) *at = *at == ',' ? '.' : *at;  // the decimal point of many languages
  return text;
}

// Reads the fields of a payload, one after the other.
class FieldReader {
 public:
  explicit FieldReader(Bytes data) : data_(data) {}

  int64_t take(const char *what, int64_t low, int64_t high) {
    if (at_ >= data_.size) corrupt(std::string("ends before ") + what);
    int64_t value;
    try {
      value = decode_varint(data_, at_);
    } catch (const Error &error) {
      corrupt(std::string(what) + ": " + error.what());
    }
    if (value < low || value > high)
      throw Error(Fault::limit, std::string("header: ") + what + " is " + std::to_string(value) +
                                    "; this version takes " + std::to_string(low) + " to " + std::to_string(high));
    return value;
  }

  template <class T>
  void number(const char *, const char *what, T &member, int64_t low, int64_t high) {
    member = T(take(what, low, high));
  }

  template <class T, size_t count>
  void choice(const char *, const char *what, T &member, const char *const (&)[count]) {
    member = T(take(what, 0, int64_t(count) - 1));
  }

  void numbers(const char *, const char *what, const char *one, std::vector<int> &members, int64_t most, int64_t high) {
    members.resize(size_t(take(what, 0, most)));
    for (int &member : members) member = int(take(one, 1, high));
  }

  int64_t flags(Header &header) {
    const int64_t flags = flags_ = take("the flags", 0, kAllFlags);
    visit_flags(header, [&](int64_t bit, const char *, bool &member) { member = flags & bit; });
    if ((flags & kTransparent) && (flags & kNodata)) corrupt("pixels are either transparent or without data");
    header.masked = flags & kTransparent ? Masked::transparent : flags & kNodata ? Masked::nodata : Masked::none;
    return flags;
  }

  // One range for all colours, or one for each.
  void ranges(Header &header) {
    header.low.assign(size_t(header.spec.channels), 0);
    header.high.assign(size_t(header.spec.channels), largest_of(header.sample_type));
    const bool is_float = header.sample_type == SampleType::f32, are_counted = flags_ & kRanges;
    if (!is_float && !are_counted) return;
    const int64_t colours = header.colours(), count = are_counted ? take("the sample ranges", 1, colours) : 1;
    if (count != 1 && count != colours) corrupt("sample ranges of another number of channels");
    if (count == 1 && is_float && are_counted) corrupt("a flag for one sample range of floats");
    for (int64_t c = 0; c < count; ++c) {
      float range[2];
      unpack("the sample range", range, 2);
      for (int64_t at = c; at < (count == 1 ? colours : c + 1); ++at)
        header.low[size_t(at)] = range[0], header.high[size_t(at)] = range[1];
    }
  }

  void real(const char *, const char *what, double &member) { unpack(what, &member, 1); }

  void blob(const char *, const char *what, std::vector<uint8_t> &member, int64_t most) {
    member.resize(size_t(take(what, 1, most)));
    unpack(what, member.data(), member.size());
  }

  bool at_end() const { return at_ == data_.size; }

 private:
  template <class T>
  void unpack(const char *what, T *values, size_t count) {
    const size_t bytes = count * sizeof(T);
    if (bytes > data_.size - at_) corrupt(std::string("ends before ") + what);
    std::memcpy(values, data_.data + at_, bytes);
    at_ += bytes;
  }

  Bytes data_;
  size_t at_ = 0;
  int64_t flags_ = 0;
};

// Appends the fields to a payload.
class FieldWriter {
 public:
  explicit FieldWriter(std::vector<uint8_t> &payload) : payload_(payload) {}

  template <class T>
  void number(const char *, const char *, const T &member, int64_t, int64_t) {
    encode_varint(int64_t(member), payload_);
  }

  template <class T, size_t count>
  void choice(const char *, const char *, const T &member, const char *const (&)[count]) {
    encode_varint(int64_t(member), payload_);
  }

  void numbers(const char *, const char *, const char *, const std::vector<int> &members, int64_t, int64_t) {
    encode_varint(int64_t(members.size()), payload_);
    for (const int member : members) encode_varint(member, payload_);
  }

  int64_t flags(Header &header) {
    ranges_ = stated_ranges(header);
    const bool are_counted = ranges_ && (ranges_ > 1 || header.sample_type != SampleType::f32);
    flags_ = (header.tile ? kTiled : 0) | (are_counted ? kRanges : 0);
    flags_ |= header.network.empty() ? 0 : kNetwork;
    flags_ |= header.masked == Masked::transparent ? kTransparent : header.masked == Masked::nodata ? kNodata : 0;
    visit_flags(header, [&](int64_t bit, const char *, bool member) { flags_ |= member ? bit : 0; });
    encode_varint(flags_, payload_);
    return flags_;
  }

  void ranges(const Header &header) {
    if (flags_ & kRanges) encode_varint(int64_t(ranges_), payload_);
    for (size_t c = 0; c < ranges_; ++c) {
      const float range[] = {float(header.low[c]), float(header.high[c])};
      append(range, sizeof range);
    }
  }

  void real(const char *, const char *, const double &member) { append(&member, sizeof member); }

  void blob(const char *, const char *, const std::vector<uint8_t> &member, int64_t) {
    encode_varint(int64_t(member.size()), payload_);
    append(member.data(), member.size());
  }

 private:
  // How many ranges are stated: none of integers that span their type, one where all colours have the same.
  static size_t stated_ranges(const Header &header) {
    const auto colours = size_t(header.colours());
    size_t count = 1;
    for (size_t c = 1; c < colours; ++c)
      if (header.low[c] != header.low[0] || header.high[c] != header.high[0]) count = colours;
    const bool is_whole = !header.low[0] && header.high[0] == largest_of(header.sample_type);
    return count == 1 && is_whole && header.sample_type != SampleType::f32 ? 0 : count;
  }

  void append(const void *values, size_t count) {
    const auto *bytes = static_cast<const uint8_t *>(values);
    payload_.insert(payload_.end(), bytes, bytes + count);
  }

  std::vector<uint8_t> &payload_;
  size_t ranges_ = 0;
  int64_t flags_ = 0;
};

void check_model(const ModelSpec &spec) {
  const ContextSpec &context = spec.context;
  const bool is_one = spec.per_seed == 1 && spec.features == spec.channels + 3;
  const bool holds_gaussian = is_one && !spec.hidden && context.hash_resolutions.empty();
  const bool holds_features = spec.hidden && !context.neighbours;
  if (!(spec.is_plain() ? holds_gaussian : holds_features)) corrupt("settings that contradict each other");
}

void check_layout(const Header &header) {
  const std::string name = kLayoutNames[int(header.channels)];
  const bool is_coloured = header.channels == ChannelLayout::rgb || header.channels == ChannelLayout::rgba;
  if (header.spec.luma_space && !(is_coloured && header.spec.is_plain())) corrupt(name + " has no luma space");
  const int given = header.spec.channels;
  const int expected = header.channels == ChannelLayout::multi ? given : int(header.channels);
  if (expected != given) corrupt(std::to_string(given) + " channels cannot be " + name);
}

bool is_sample(const Header &header, double value) {
  if (header.sample_type == SampleType::f32) return true;
  return value >= 0 && value <= largest_of(header.sample_type) && value == std::trunc(value);
}

void check_ranges(const Header &header) {
  for (size_t c = 0; c < size_t(header.colours()); ++c) {
    const double low = header.low[c], high = header.high[c];
    const bool is_sound = std::fabs(low) <= kMaxSample && std::fabs(high) <= kMaxSample && low < high;
    if (!is_sound || !is_sample(header, low) || !is_sample(header, high))
      corrupt("a sample range of " + text_of(low) + " to " + text_of(high));
  }
}

void check_masks(const Header &header) {
  const std::string layout = kLayoutNames[int(header.channels)];
  if (header.masked == Masked::transparent && header.alpha() < 0) corrupt(layout + " has no transparent pixels");
  const bool is_nodata = header.masked == Masked::nodata;
  if (header.has_band_masks && (!is_nodata || header.colours() < 2))
    corrupt("masks of bands without nodata, or of a single band");
  if (is_nodata && !is_sample(header, header.nodata))
    corrupt(std::string("no sample of ") + kSampleNames[int(header.sample_type)] + " is " + text_of(header.nodata));
}

void read_network(Header &header) {
  if (header.network.empty()) return;
  if (!header.spec.restoration) corrupt("a network of restoration that no tile can name");
  try {
    const Bytes file{header.network.data(), header.network.size()};
    header.own_network = std::make_shared<const RestorationNetwork>(parse_restoration(file));
  } catch (const std::logic_error &error) {
    corrupt(error.what());
  }
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
  FieldReader fields(payload);
  const int64_t version = fields.take("the format version", 0, 1 << 20);
  if (version != kFormatVersion)
    throw Error(Fault::unsupported, "header: format version " + std::to_string(version) +
                                        "; this program reads version " + std::to_string(kFormatVersion) + " alone");
  Header header{};
  visit_fields(header, fields);
  if (!fields.at_end()) corrupt("longer than its fields");
  check_model(header.spec), check_layout(header), check_ranges(header), check_masks(header), check_tiles(header);
  read_network(header);
  return header;
}

std::vector<uint8_t> encode_header(Header header) {
  std::vector<uint8_t> payload;
  encode_varint(kFormatVersion, payload);
  FieldWriter fields(payload);
  visit_fields(header, fields);
  return payload;
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
