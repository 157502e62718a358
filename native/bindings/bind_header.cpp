#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bindings/arrays.hpp"
#include "bindings/bindings.hpp"
#include "bitstream/header.hpp"
#include "bitstream/header_fields.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

// Fills a dictionary with the fields, by their paths.
class ToPython {
 public:
  nb::dict fields;

  template <class T>
  void number(const char *name, const char *, const T &member, int64_t, int64_t) {
    set(name, nb::int_(member));
  }

  template <class T, size_t count>
  void choice(const char *name, const char *, const T &member, const char *const (&names)[count]) {
    const char *const chosen = names[int(member)];
    set(name, chosen ? nb::object(nb::str(chosen)) : nb::none());
  }

  void numbers(const char *name, const char *, const char *, const std::vector<int> &members, int64_t, int64_t) {
    set(name, nb::tuple(nb::cast(members)));
  }

  int64_t flags(sgi::Header &header) {
    sgi::visit_flags(header, [&](int64_t, const char *name, bool member) { set(name, nb::bool_(member)); });
    choice("masked", "", header.masked, sgi::kMaskedNames);
    return sgi::kAllFlags;
  }

  // As in Python's `SampleRange`: two numbers where all colours have the same, else two tuples.
  void ranges(const sgi::Header &header) {
    std::vector<double> low = header.low, high = header.high;
    low.resize(size_t(header.colours())), high.resize(size_t(header.colours()));
    const auto is_one = [](const std::vector<double> &levels) {
      return std::count(levels.begin(), levels.end(), levels[0]) == int64_t(levels.size());
    };
    if (is_one(low) && is_one(high))
      set("sample_range", nb::make_tuple(low[0], high[0]));
    else
      set("sample_range", nb::make_tuple(nb::tuple(nb::cast(low)), nb::tuple(nb::cast(high))));
  }

  void real(const char *name, const char *, const double &member) { set(name, nb::float_(member)); }

  void blob(const char *name, const char *, const std::vector<uint8_t> &member, int64_t) {
    set(name, nb::bytes(member.data(), member.size()));
  }

 private:
  void set(const char *name, const nb::object &value) { fields[name] = value; }
};

// Takes the fields from the attributes of an object.
class FromPython {
 public:
  explicit FromPython(nb::object header) : header_(std::move(header)) {}

  template <class T>
  void number(const char *name, const char *, T &member, int64_t, int64_t) {
    member = nb::cast<T>(get(name));
  }

  template <class T, size_t count>
  void choice(const char *name, const char *, T &member, const char *const (&names)[count]) {
    const nb::object value = get(name);
    const auto is_value = [&](const char *one) { return one ? value.equal(nb::str(one)) : value.is_none(); };
    const auto chosen = std::find_if(names, names + count, is_value);
    sgi::require(chosen != names + count, "no value of the header's enumerations has this name");
    member = T(chosen - names);
  }

  void numbers(const char *name, const char *, const char *, std::vector<int> &members, int64_t, int64_t) {
    members = nb::cast<std::vector<int>>(get(name));
  }

  int64_t flags(sgi::Header &header) {
    sgi::visit_flags(header, [&](int64_t, const char *name, bool &member) { member = bool(nb::bool_(get(name))); });
    choice("masked", "", header.masked, sgi::kMaskedNames);
    return sgi::kAllFlags;
  }

  void ranges(sgi::Header &header) {
    const auto range = nb::cast<std::vector<nb::object>>(get("sample_range"));
    sgi::require(range.size() == 2, "a sample range has two ends");
    header.low = levels(range[0], header, 0), header.high = levels(range[1], header, largest_of(header.sample_type));
  }

  void real(const char *name, const char *, double &member) { member = nb::cast<double>(get(name)); }

  void blob(const char *name, const char *, std::vector<uint8_t> &member, int64_t) {
    const auto given = nb::cast<nb::bytes>(get(name));
    const sgi::Bytes bytes = sgi::bytes_of(given);
    member.assign(bytes.data, bytes.data + bytes.size);
  }

 private:
  // The attribute at a path.
  nb::object get(const char *name) { return nb::module_::import_("operator").attr("attrgetter")(name)(header_); }

  // One end of the range, of each channel; that of alpha is `end`.
  static std::vector<double> levels(const nb::object &given, const sgi::Header &header, double end) {
    std::vector<double> found(size_t(header.colours()));
    if (nb::isinstance<nb::tuple>(given)) {
      const auto own = nb::cast<std::vector<double>>(given);
      sgi::require(own.size() == found.size(), "ranges of another number of colours");
      found = own;
    } else {
      std::fill(found.begin(), found.end(), nb::cast<double>(given));
    }
    found.resize(size_t(header.spec.channels), end);
    return found;
  }

  nb::object header_;
};

nb::dict decode(const nb::bytes &payload) {
  sgi::Header header = sgi::decode_header(sgi::bytes_of(payload));
  ToPython fields;
  sgi::visit_fields(header, fields);
  return fields.fields;
}

nb::bytes encode(nb::object given) {
  sgi::Header header{};
  FromPython fields(std::move(given));
  sgi::visit_fields(header, fields);
  const std::vector<uint8_t> payload = sgi::encode_header(std::move(header));
  return nb::bytes(payload.data(), payload.size());
}

}  // namespace

void bind_header(nb::module_ &m) {
  m.attr("FORMAT_VERSION") = sgi::kFormatVersion;
  m.attr("MAX_SIDE") = sgi::kMaxSide, m.attr("MAX_CHANNELS") = sgi::kMaxChannels;
  m.attr("MAX_TILES") = sgi::kMaxTiles, m.attr("MIN_TILE") = sgi::kMinTile, m.attr("MAX_APRON") = sgi::kMaxApron;
  m.def("decode_header", &decode, "payload"_a, "The fields of chunk H by their paths, such as spec.context.prior.");
  m.def("encode_header", &encode, "header"_a, "The payload of chunk H of a header with these fields.");
}
