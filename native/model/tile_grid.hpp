// The tile grid: how a picture is cut into tiles, and which tiles draw a run of output pixels.
#pragma once
#include <cstdint>
#include <vector>

namespace sgi {

struct PixelRect {
  int64_t x, y, width, height;
};

// Output pixels first ... last - 1 along an axis that tile `tile` draws alone, or with the next one: then `weight`
// [last - first] is the next one's share, else it is empty.
struct TileSegment {
  int64_t first, last, tile;
  std::vector<float> weight;
};

// `length` pixels cut into `count` cores of nearly equal size. A tile reaches `apron` pixels beyond its core on each
// side where there is another tile; over the 2 apron pixels that two tiles share one fades into the other.
struct TileAxis {
  int64_t length, count, apron;

  int64_t edge(int64_t index) const { return index * length / count; }
  // First pixel of a tile, and the one behind its last.
  int64_t begin(int64_t index) const { return edge(index) - (index > 0 ? apron : 0); }
  int64_t end(int64_t index) const { return edge(index + 1) + (index + 1 < count ? apron : 0); }
  // The runs of output pixels first ... first + count - 1 of a picture rendered at `scale` from `start` on, in pixels.
  std::vector<TileSegment> segments(double start, double scale, int64_t first, int64_t count) const;
};

// Tiles are numbered row by row. `tile`: the largest side of a core, 0 for a single tile.
struct TileGrid {
  int64_t width, height, tile, apron;

  TileAxis across() const { return axis(width); }
  TileAxis down() const { return axis(height); }
  int64_t count() const { return across().count * down().count; }
  int64_t number(int64_t column, int64_t row) const { return row * across().count + column; }
  // What a tile covers, its apron included.
  PixelRect rect(int64_t number) const;

 private:
  TileAxis axis(int64_t length) const { return {length, tile ? (length + tile - 1) / tile : 1, apron}; }
};

}  // namespace sgi
