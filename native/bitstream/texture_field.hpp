// The symbols of a texture layer as planes: those of a cell of side n are where its pixels are, [n, n] by frequency.
#pragma once
#include <cstdint>
#include <vector>

#include "model/texture_axis.hpp"

namespace sgi {

constexpr int kUnitLog = kTextureLeast, kUnit = 1 << kUnitLog;  // maps count in units, the smallest cells
constexpr int kTextureMost = (1 << 14) + 6;                     // of a symbol's magnitude

// A node of the quadtree.
struct TextureCell {
  int64_t x, y;  // pixels
  int log;

  int side() const { return 1 << log; }
  TextureCell child(int number) const {
    const int half = side() / 2;
    return {x + (number & 1) * half, y + (number >> 1) * half, log - 1};
  }
};

// Of which symbols a field keeps.
enum class KeptSymbols { all, last_rows };  // the latter of the row of roots that is coded and of the one above

struct TextureField {
  TextureField(int64_t roots_across, int64_t roots_down, int channels, KeptSymbols kept = KeptSymbols::all);

  int64_t width, height;  // pixels, of all roots
  int channels;
  std::vector<uint8_t> log_size;  // [height, width] / unit: of the cell with texture that lies there, else 0
  std::vector<int8_t> contrast;   // [height, width] / 32: the index that scales a root's steps
  int64_t rows;                   // of symbols that are kept
  std::vector<int16_t> symbols;   // [C, rows, width]
  std::vector<uint8_t> extent;    // [C, height, width] / unit: of 16, how far up the frequencies go

  int64_t units() const { return width / kUnit; }
  int64_t unit(int64_t x, int64_t y) const { return (y >> kUnitLog) * units() + (x >> kUnitLog); }
  int64_t root(int64_t x, int64_t y) const {
    return (y >> kTextureRoot) * (width >> kTextureRoot) + (x >> kTextureRoot);
  }
  int64_t unit_count() const { return int64_t(log_size.size()); }
  int16_t *at(int channel, const TextureCell &cell) { return &symbols[place(channel, cell)]; }
  const int16_t *at(int channel, const TextureCell &cell) const { return &symbols[place(channel, cell)]; }

  // Makes room for a row of roots that begins at this row of pixels, in the place of rows that are not kept.
  void begin_roots(int64_t y);

  // Says that a cell holds texture, or with log 0 none.
  void mark(const TextureCell &cell, int log);
  // A diagonal of a cell's channel beyond which there are no symbols, -1 where there are none.
  int last_at_most(int channel, const TextureCell &cell) const {
    const int reach = extent[size_t(channel * unit_count() + unit(cell.x, cell.y))];
    return (reach * (2 * cell.side() - 2) + 14) / 15 - 1;
  }
  // Sets a channel's symbols [n, n] of a cell whose last diagonal with a symbol is `last`, -1 for none.
  void set(const TextureCell &cell, int channel, const int16_t *values, int last);
  // The same where there are none yet: touches only the rows that get some.
  void add(const TextureCell &cell, int channel, const int16_t *values, int last);
  // States extents by what symbols there are.
  void find_extents();
  // Takes a cell's texture away.
  void clear(const TextureCell &cell);

 private:
  size_t place(int channel, const TextureCell &cell) const {
    return size_t((channel * rows + (rows == height ? cell.y : cell.y % kLastRows)) * width + cell.x);
  }
  void put(const TextureCell &cell, int channel, const int16_t *values, int rows);
  void state_extent(const TextureCell &cell, int channel, int last);

  static constexpr int64_t kLastRows = 2 << kTextureRoot;
};

// A frequency (u, v) of a cell; index: v * n + u.
struct Frequency {
  int16_t index;
  uint8_t u, v;

  int diagonal() const { return u + v; }
};

// The frequencies of a cell by diagonals from low to high, within one by rising u.
const std::vector<Frequency> &texture_scan(int log);

// The last diagonal of a cell's values [n, n] with a symbol, -1 for none; `stride` from one row to the next.
int last_diagonal(const int16_t *values, int64_t stride, int log);

}  // namespace sgi
