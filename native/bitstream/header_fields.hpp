// The fields of the header chunk in their order (docs/format.md, "Header fields"): the name of each, what messages call
// it, what it may be, and when it is there. What reads or writes headers goes through them as a visitor: the chunk's
// reader and writer (header.cpp), and the conversions of the bindings.
#pragma once
#include <algorithm>

#include "bitstream/header.hpp"

namespace sgi {

constexpr int kFormatVersion = 1;         // the only one that there is
constexpr int64_t kMaxNetwork = 1 << 14;  // bytes, about the products that a pixel takes
constexpr int64_t kMaxFeatures = 1 << 13, kMaxHidden = 1 << 12, kMaxHashLevels = 32, kMaxHashResolution = 1 << 14;

// Names of the values of enumerations; nullptr for none.
constexpr const char *kLayoutNames[] = {"multi", "gray", "gray+alpha", "rgb", "rgba"};
constexpr const char *kSampleNames[] = {"uint8", "uint16", "float32"};
constexpr const char *kProfileNames[] = {"default", "paper"};
constexpr const char *kSeedLayoutNames[] = {"adaptive", "uniform"};
constexpr const char *kMaskedNames[] = {nullptr, "transparent", "nodata"};

// Bits of the flags that say which fields follow, and which pixels tiles may mask.
constexpr int64_t kTiled = 1, kTransparent = 2, kNodata = 4, kRanges = 64, kNetwork = 512, kAllFlags = 1023;

// The flags that are members: `visit` takes the bit, the name and the member.
template <class Visit>
void visit_flags(Header &header, const Visit &visit) {
  visit(8, "spec.texture", header.spec.texture);
  visit(16, "spec.luma_space", header.spec.luma_space);
  visit(32, "spec.restoration", header.spec.restoration);
  visit(128, "has_band_masks", header.has_band_masks);
  visit(256, "has_exact", header.has_exact);
}

// Names are paths of members, the same in Python. A visitor has
//   number(name, what, member, low, high)          an integer
//   choice(name, what, member, names)              an enumeration, as an integer
//   numbers(name, what, one, members, most, high)  so many integers from 1 to `high`, behind their count
//   flags(header)                                  the member flags and what tiles may mask; returns which parts follow
//   ranges(header)                                 the samples that 0 and 1 stand for
//   real(name, what, member)                       a float of 64 bits
//   blob(name, what, member, most)                 so many bytes, behind their count
template <class Visitor>
void visit_fields(Header &header, Visitor &visit) {
  ModelSpec &spec = header.spec;
  ContextSpec &context = spec.context;
  visit.number("width", "the width", header.width, 1, kMaxSide);
  visit.number("height", "the height", header.height, 1, kMaxSide);
  visit.number("spec.channels", "the number of channels", spec.channels, 1, kMaxChannels);
  visit.choice("channels", "the channel layout", header.channels, kLayoutNames);
  visit.choice("sample_type", "the sample type", header.sample_type, kSampleNames);
  visit.choice("profile", "the profile", header.profile, kProfileNames);
  visit.choice("spec.layout", "the seed layout", spec.layout, kSeedLayoutNames);
  const int64_t flags = visit.flags(header);
  visit.number("spec.per_seed", "K", spec.per_seed, 1, 64);
  visit.number("spec.features", "D", spec.features, 1, kMaxFeatures);
  visit.number("spec.hidden", "the decoders' width", spec.hidden, 0, kMaxHidden);
  visit.number("spec.base_cell", "the base cell", spec.base_cell, 0, 1 << 12);
  visit.number("colour_step", "the base step", header.colour_step, 0, 255);
  visit.number("family", "the table family", header.family, 0, 1);
  visit.number("spec.context.prior", "the prior", context.prior, 0, 255);
  visit.number("spec.context.hidden", "the context model's width", context.hidden, 1, kMaxHidden);
  visit.number("spec.context.neighbours", "the neighbours", context.neighbours, 0, 6);
  visit.numbers("spec.context.hash_resolutions", "the hash levels", "a hash resolution", context.hash_resolutions,
                kMaxHashLevels, kMaxHashResolution);
  if (!context.hash_resolutions.empty()) {
    visit.number("spec.context.hash_features", "the hash features", context.hash_features, 1, 64);
    visit.number("spec.context.hash_log2_entries", "the hash entries", context.hash_log2_entries, 1, 20);
  }
  if (flags & kTiled) {
    visit.number("tile", "the tile size", header.tile, kMinTile, kMaxSide);
    visit.number("apron", "the apron", header.apron, 0, std::min(header.tile / 4, kMaxApron));
  }
  visit.ranges(header);
  if (flags & kNodata) visit.real("nodata", "the nodata value", header.nodata);
  if (flags & kNetwork) visit.blob("network", "the network of restoration", header.network, kMaxNetwork);
}

}  // namespace sgi
