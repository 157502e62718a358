#include "decoder/compositor.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/kept_floats.hpp"
#include "base/thread_pool.hpp"

namespace sgi {
namespace {

constexpr int64_t kMaskPixels = 1 << 20;  // of a mask that are looked at at a time

// A part of a view that the same tiles draw: one, or two or four that fade into each other.
struct Piece {
  const TileSegment &down, &across;
};

std::vector<int64_t> tiles_of(const TileGrid &grid, const Piece &piece) {
  std::vector<int64_t> numbers;
  for (int64_t row = piece.down.tile; row <= piece.down.tile + !piece.down.weight.empty(); ++row)
    for (int64_t column = piece.across.tile; column <= piece.across.tile + !piece.across.weight.empty(); ++column)
      numbers.push_back(grid.number(column, row));
  return numbers;
}

// The share at place i of the tile before an edge, or behind it.
float share_at(const TileSegment &segment, bool is_behind, int64_t i) {
  if (segment.weight.empty()) return 1.0f;
  return is_behind ? segment.weight[i] : 1 - segment.weight[i];
}

// The tile's pixels that hold the centres of output pixels.
std::vector<int64_t> pixels_of(const OutputAxis &axis, int64_t size) {
  std::vector<int64_t> pixels(axis.count);
  for (int64_t i = 0; i < axis.count; ++i)
    pixels[i] = int64_t(std::clamp(std::floor(axis.centre(i)), 0.0, double(size - 1)));
  return pixels;
}

// Draws the parts of one view.
class Compositor {
 public:
  Compositor(const Header &header, const PictureView &view, const Drawing &drawing)
      : header_(header), view_(view), drawing_(drawing), format_(drawing.format),
        values_(header, kValues, std::nullopt, format_.isa) {}

  void draw(const Piece &piece, const std::vector<TileRenderer *> &tiles, int64_t x, int64_t y,
            const PixelBlock &block) {
    const bool alone = tiles.size() == 1;
    if (alone && !drawing_.dither) {
      tiles[0]->draw(view_, x, y, block, format_, drawing_.threads);
    } else {
      const PixelBlock drawn = held(drawn_, block);
      if (alone)
        tiles[0]->draw(view_, x, y, drawn, values_, drawing_.threads);
      else
        blend(piece, tiles, x, y, drawn);
      const float *values = static_cast<const float *>(drawn.first);
      if (drawing_.dither)
        format_.store_dithered(values, x, y, block, drawing_.threads);
      else
        format_.store(values, block, drawing_.threads);
    }
    if (format_.is_mapped()) mark(*tiles[0], x, y, block);
  }

 private:
  // Floats of the size of a block.
  PixelBlock held(KeptFloats &memory, const PixelBlock &block) const {
    const int64_t stride = block.columns * format_.channels;
    return {memory.room(stride * block.rows), block.columns, block.rows, stride};
  }

  void blend(const Piece &piece, const std::vector<TileRenderer *> &tiles, int64_t x, int64_t y,
             const PixelBlock &total) {
    const PixelBlock one = held(one_, total);
    const int across = piece.across.weight.empty() ? 1 : 2;
    float *sums = static_cast<float *>(total.first);
    std::fill_n(sums, total.stride * total.rows, 0.0f);
    for (size_t i = 0; i < tiles.size(); ++i) {
      tiles[i]->draw(view_, x, y, one, values_, drawing_.threads);
      const float *drawn = static_cast<const float *>(one.first);
      const bool below = int(i) / across, right = int(i) % across;
      parallel_for(one.rows, drawing_.threads, [&](int64_t row) {
        const float share = share_at(piece.down, below, row);
        for (int64_t column = 0, at = row * one.stride; column < one.columns; ++column) {
          const float weight = share * share_at(piece.across, right, column);
          for (int c = 0; c < format_.channels; ++c, ++at) sums[at] += drawn[at] * weight;
        }
      });
    }
  }

  // Stores what the tile says of pixels apart from its model, by the pixel that holds the centre of each.
  void mark(const TileRenderer &tile, int64_t x, int64_t y, const PixelBlock &block) const {
    if (header_.masked == Masked::none && tile.exact().empty()) return;
    const PixelRect &place = tile.place();
    const auto columns = pixels_of({view_.x - double(place.x), view_.sx, x, block.columns}, place.width);
    const auto rows = pixels_of({view_.y - double(place.y), view_.sy, y, block.rows}, place.height);
    if (header_.masked != Masked::none) mark_empty(tile, columns, rows, block);
    const int64_t colours = header_.colours();
    const auto pixels = [](const std::vector<int64_t> &axis, int64_t pixel) {
      const auto found = std::equal_range(axis.begin(), axis.end(), pixel);
      return std::pair(found.first - axis.begin(), found.second - found.first);
    };
    for (const ExactSample &sample : tile.exact()) {
      const int64_t pixel = int64_t(sample.place) / colours;
      const auto [top, high] = pixels(rows, pixel / place.width);
      const auto [left, wide] = pixels(columns, pixel % place.width);
      if (high && wide)
        format_.state(sample.value, int(int64_t(sample.place) % colours), format_.part(block, left, top, wide, high));
    }
  }

  // Stores nothing where the tile's masks say so.
  void mark_empty(const TileRenderer &tile, const std::vector<int64_t> &columns, const std::vector<int64_t> &rows,
                  const PixelBlock &block) const {
    const int64_t each = std::clamp<int64_t>(kMaskPixels / block.columns, 1, block.rows);
    const int colours = header_.colours(), masks = std::max(1, int(tile.masks().size()));
    std::vector<uint8_t> empty(each * block.columns);
    for (int64_t top = 0; top < block.rows; top += each) {
      const int64_t count = std::min(each, block.rows - top);
      for (int band = 0; band < masks; ++band) {
        const BandMask mask = tile.masks().empty() ? BandMask{nullptr, tile.is_empty()} : tile.masks()[size_t(band)];
        if (mask.pixels)
          mask.pixels->sample(columns.data(), block.columns, rows.data() + top, count, empty.data());
        else
          std::fill(empty.begin(), empty.end(), uint8_t(mask.is_all));
        for (int64_t row = 0; row < count; ++row) {
          const uint8_t *of_row = empty.data() + row * block.columns;
          const PixelBlock part = format_.part(block, 0, top + row, block.columns, 1);
          if (header_.masked == Masked::transparent)
            format_.mark_transparent(of_row, part);
          else
            format_.mark_nodata(of_row, part, band, masks == 1 ? colours : band + 1);
        }
      }
    }
  }

  const Header &header_;
  const PictureView view_;
  const Drawing &drawing_;
  const SampleFormat &format_;
  const SampleFormat values_;
  KeptFloats drawn_, one_;
};

// Decodes ahead while it lives.
class Ahead {
 public:
  Ahead(TileCache &tiles, const std::vector<int64_t> &numbers, const PictureView &view) : tiles_(tiles) {
    tiles.start(numbers, view);
  }
  ~Ahead() { tiles_.stop(); }

 private:
  TileCache &tiles_;
};

// All tiles of these pieces, in the order in which they are rendered.
std::vector<int64_t> tiles_of(const TileGrid &grid, const std::vector<TileSegment> &down,
                              const std::vector<TileSegment> &across) {
  std::vector<int64_t> wanted;
  std::set<int64_t> seen;
  for (const TileSegment &row : down)
    for (const TileSegment &column : across)
      for (const int64_t number : tiles_of(grid, {row, column}))
        if (seen.insert(number).second) wanted.push_back(number);
  return wanted;
}

}  // namespace

void decode_tiles(const Header &header, TileCache &tiles, const PictureView &view,
                  const std::function<void()> &between) {
  const TileGrid grid = header.grid();
  const auto wanted = tiles_of(grid, grid.down().segments(view.y, view.sy, 0, view.rows),
                               grid.across().segments(view.x, view.sx, 0, view.columns));
  const Ahead ahead(tiles, wanted, view);
  for (const int64_t number : wanted) {
    if (tiles.is_half_full()) break;
    if (between) between();
    TileRenderer &tile = tiles.tile(number);
    if (!view.is_plain()) tile.complete();  // the view may be much larger than the tile
  }
}

void draw_view(const Header &header, TileCache &tiles, const PictureView &view, int64_t top, const PixelBlock &block,
               const Drawing &drawing) {
  const TileGrid grid = header.grid();
  const auto down = grid.down().segments(view.y, view.sy, top, block.rows);
  const auto across = grid.across().segments(view.x, view.sx, 0, view.columns);
  const Ahead ahead(tiles, tiles_of(grid, down, across), view);
  Compositor compositor(header, view, drawing);
  for (const TileSegment &row : down)
    for (const TileSegment &column : across) {
      if (drawing.between) drawing.between();
      std::vector<TileRenderer *> here;
      for (const int64_t number : tiles_of(grid, {row, column})) here.push_back(&tiles.tile(number));
      compositor.draw(
          {row, column}, here, column.first, top + row.first,
          drawing.format.part(block, column.first, row.first, column.last - column.first, row.last - row.first));
    }
}

}  // namespace sgi
