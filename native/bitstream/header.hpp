// The header chunk: what picture this is and what kind of model it holds (docs/format.md, "Header fields").
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "base/bytes.hpp"
#include "base/sample.hpp"
#include "model/spec.hpp"
#include "model/tile_grid.hpp"

namespace sgi {

struct RestorationNetwork;

enum class ChannelLayout { multi, gray, gray_alpha, rgb, rgba };
enum class Masked { none, transparent, nodata };

constexpr int64_t kMaxSide = int64_t(1) << 24, kMaxTiles = int64_t(1) << 20, kMinTile = 32, kMaxApron = 256;
constexpr int kMaxChannels = 64;
constexpr double kMaxSample = 1e38;  // of a range, either way: floats hold differences of samples

struct Header {
  int64_t width, height;  // pixels
  ChannelLayout channels;
  SampleType sample_type;
  std::vector<double> low, high;  // [C] samples that 0 and 1 of the model stand for; alpha spans its type
  int profile;                    // 0 default, 1 paper
  ModelSpec spec;
  int colour_step, family;  // index of the base colour step; of the frequency tables
  int64_t tile, apron;  // the largest side of a core, 0 for one tile; pixels that a tile reaches over its neighbours
  Masked masked;        // which pixels tiles may say hold nothing
  double nodata;        // what such a pixel holds, with Masked::nodata
  bool has_band_masks;  // whether tiles may say so of each band by itself
  bool has_exact;       // whether tiles list samples that they state exactly
  std::vector<uint8_t> network;  // the file of the picture's own network of restoration; empty for none
  std::shared_ptr<const RestorationNetwork> own_network;  // what it holds, once a header was decoded

  // The channel that is alpha, or -1; the channels besides it.
  int alpha() const;
  int colours() const { return alpha() < 0 ? spec.channels : spec.channels - 1; }
  TileGrid grid() const { return {width, height, tile, apron}; }
  // The header that a tile's model would have as a picture of its own.
  Header of_tile(int64_t number) const;
};

// The payload of chunk H. Throws Error: unsupported for another version, limit for a field beyond its cap, corrupt for
// fields that contradict each other.
Header decode_header(Bytes payload);
// The reverse. Nothing is checked but that no number is negative (Error, usage): who reads checks.
std::vector<uint8_t> encode_header(Header header);

}  // namespace sgi
