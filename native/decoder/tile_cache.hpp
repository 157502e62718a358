// Tiles of a stream are decoded once, several at a time, and kept while there is room.
#pragma once
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <vector>

#include "bitstream/stream_reader.hpp"
#include "decoder/tile_renderer.hpp"

namespace sgi {

// Not safe for use by two threads at once.
class TileCache {
 public:
  TileCache(StreamReader &chunks, const DecoderSettings &settings);
  ~TileCache();

  // Throws Error: corrupt, limit, with the tile's number where there are several. Good until four others are asked for.
  TileRenderer &tile(int64_t number);
  // From here on until `stop` these tiles are asked for in this order: a few threads decode the next of them, one a
  // tile, and prepare them for a view.
  void start(const std::vector<int64_t> &numbers, const PictureView &view);
  void stop();

  // What is known of all tiles, in their order; several are decoded at a time, none is kept but a single one.
  void for_each_fact(const std::function<void(const TileFacts &)> &body);

  bool is_half_full() const { return bytes_ > settings_.cache_bytes / 2; }
  int64_t held() const { return int64_t(tiles_.size()); }
  int64_t decoded() const { return decoded_; }  // so far, to be rendered
  int64_t ahead() const { return ahead_; }      // of these before they were asked for

 private:
  class Prefetch;
  struct Kept {
    std::unique_ptr<TileRenderer> tile;
    int64_t bytes;
    std::list<int64_t>::iterator use;
  };

  void keep(int64_t number, std::unique_ptr<TileRenderer> tile);
  std::vector<uint8_t> payload(int64_t number);
  void weigh(Kept &kept);

  StreamReader &chunks_;
  const DecoderSettings settings_;
  std::map<int64_t, Kept> tiles_;
  std::list<int64_t> uses_;  // the least recent one first
  int64_t bytes_ = 0, decoded_ = 0, ahead_ = 0;
  std::vector<int64_t> wanted_;  // since `start`, in their order
  size_t expected_ = 0;          // of these those that the source was told of
  std::unique_ptr<Prefetch> prefetch_;
};

}  // namespace sgi
