// What a tile of the file draws, for a page that draws it by itself (viewer/src/gpu/): its Gaussians, base layer,
// texture.
#include <emscripten.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "decoder/stream.hpp"
#include "guarded.hpp"
#include "raster/binning.hpp"

namespace {

using namespace sgi;

constexpr int kFacts = 16;

// Red, green and blue of a pixel's channels: the first one thrice where there are fewer than three.
int shown(int channels, int colour) { return channels < 3 ? 0 : colour; }

// Eight numbers each: centre; of the triangle L with L Lᵀ the covariance its parts xx, yx, yy; colour. Those that the
// rasteriser leaves out are left out. Returns how many there are.
int64_t add_gaussians(const GaussianSet &all, std::vector<float> &out) {
  int64_t count = 0;
  for (int64_t i = 0; i < all.count(); ++i) {
    const float *mean = &all.means[size_t(2 * i)], *covariance = &all.covariances[size_t(3 * i)];
    Splat splat;
    if (!prepare_splat(mean, covariance, 1, splat)) continue;
    const double xx = covariance[0], xy = covariance[1], yy = covariance[2], width = std::sqrt(xx);
    out.insert(out.end(), {mean[0], mean[1], float(width), float(xy / width), float(std::sqrt(yy - xy * xy / xx))});
    for (int c = 0; c < 3; ++c) out.push_back(all.colours[size_t(i * all.channels + shown(all.channels, c))]);
    ++count;
  }
  return count;
}

// Four numbers for each cell of the base layer: colour and 0.
void add_base(const std::vector<double> &base, int channels, std::vector<float> &out) {
  const size_t cells = base.size() / size_t(channels);
  for (size_t i = 0; i < cells; ++i) {
    for (int c = 0; c < 3; ++c) out.push_back(float(base[size_t(shown(channels, c)) * cells + i]));
    out.push_back(0);
  }
}

// Texture as lists: of cells (corner, width, height, first row, rows, 0, 0), of their rows of amplitudes that are not
// all zero (frequency down, first atom, atoms, 0), of atoms that are not zero (colour, frequency across).
struct TextureLists {
  std::vector<float> cells, rows, atoms;

  // values [C, side, side]; mix: null, or as of `draw_texture`.
  void add(const int32_t *corner, int side, const float *values, int channels, const float *mix) {
    const size_t first = rows.size() / 4;
    for (int v = 0; v < side; ++v) {
      const size_t begin = atoms.size() / 4;
      for (int u = 0; u < side; ++u) add_atom(values + v * side + u, side * side, channels, mix, u);
      const size_t count = atoms.size() / 4 - begin;
      if (count) rows.insert(rows.end(), {float(v), float(begin), float(count), 0});
    }
    const size_t count = rows.size() / 4 - first;
    if (count)
      cells.insert(cells.end(),
                   {float(corner[0]), float(corner[1]), float(side), float(side), float(first), float(count), 0, 0});
  }

 private:
  void add_atom(const float *value, int plane, int channels, const float *mix, int u) {
    float colour[3];
    for (int c = 0; c < 3; ++c) colour[c] = value[shown(channels, c) * plane];
    if (std::all_of(colour, colour + 3, [](float part) { return part == 0; })) return;
    for (int c = 0; c < 3; ++c)
      atoms.push_back(mix ? mix[c] * colour[0] + mix[3 + c] * colour[1] + mix[6 + c] * colour[2] : colour[c]);
    atoms.push_back(float(u));
  }
};

TextureLists lists_of(const TileRenderer &tile) {
  TextureLists lists;
  if (!tile.texture()) return lists;
  const TextureCells &texture = *tile.texture();
  const int channels = tile.header().spec.channels;
  const float *values = texture.amplitudes.get(), *mix = tile.mix().empty() ? nullptr : tile.mix().data();
  for (size_t i = 0; i < texture.log_size.size(); ++i) {
    const int side = 1 << texture.log_size[i];
    lists.add(&texture.corner[2 * i], side, values, channels, mix);
    values += channels * side * side;
  }
  return lists;
}

std::vector<float> model;

}  // namespace

extern "C" {

// Numbers of a tile, at `*at` until the next call: how many there are, or -1 for an error. The first sixteen: its place
// (x, y, width, height), Gaussians, side of the base layer's cells, columns and rows of these, cells, rows and atoms of
// texture, whether a network restores it; behind them the lists in this order.
EMSCRIPTEN_KEEPALIVE int viewer_model(Stream *stream, double number, const float **at) {
  return guarded(-1, [&] {
    const TileRenderer &tile = stream->renderer(int64_t(number));
    const int channels = tile.header().spec.channels, side = tile.header().spec.base_cell;
    const PixelRect &place = tile.place();
    const bool has_base = !tile.base().empty();
    const TextureLists lists = lists_of(tile);
    const auto cells = [&](int64_t length) { return has_base ? float((length + side - 1) / side) : 0.0f; };
    model.assign({float(place.x), float(place.y), float(place.width), float(place.height), 0, float(side),
                  cells(place.width), cells(place.height), float(lists.cells.size() / 8), float(lists.rows.size() / 4),
                  float(lists.atoms.size() / 4), float(tile.is_restored())});
    model.resize(kFacts);
    model[4] = float(add_gaussians(tile.gaussians(), model));
    if (has_base) add_base(tile.base(), channels, model);
    for (const auto *list : {&lists.cells, &lists.rows, &lists.atoms})
      model.insert(model.end(), list->begin(), list->end());
    *at = model.data();
    return int(model.size());
  });
}
}
