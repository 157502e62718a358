// The basis functions of texture cells along one axis of what is rendered (docs/format.md, "Texture").
#pragma once
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "model/constants.hpp"
#include "model/output_axis.hpp"

namespace sgi {

constexpr int kTextureSizes = kTextureRoot - kTextureLeast + 1;
constexpr int kTexturePadding = 16;  // floats that may be read behind a row of a table

// A value for each frequency of a cell of side n, [n, n].
template <class T>
using CellValues = std::array<T, 1 << (2 * kTextureRoot)>;

// Where the last cells of a tile of so many pixels end, along an axis: what lies behind is of no cell of the smallest
// size that begins inside.
inline int64_t texture_end(int64_t length) {
  constexpr int64_t kLeast = 1 << kTextureLeast;
  return (length + kLeast - 1) / kLeast * kLeast;
}

// s(t): the rising edge of a window, abrupt where it is hard.
double texture_edge(double t, bool hard);

// Where cells are along the axis.
struct CellPlaces {
  const int32_t *corner;    // [N, 2], of which the first counts
  const uint8_t *log_size;  // [N] kTextureLeast ... kTextureRoot
  int64_t count;
};

// Of a layer: as in TextureGrid, with the pixels before the tile along this axis.
struct AxisGrid {
  bool separate;
  int before;
};

// The pixels first ... first + count - 1 that the cells at one place reach, and where their basis functions are in the
// tables.
struct CellAxis {
  int64_t first, count, at, stride;
};

// Basis function k at pixel first + i is values()[at + k * stride + i] with `along_pixels`, values()[at + i * stride +
// k] else. Pixels that are larger than the tile's see the basis functions convolved with a Gaussian, as Gaussians are;
// near the borders only with what is inside. Pixels of the tile's size at whole coordinates see the same in all cells,
// which share tables.
class TextureAxis {
 public:
  // length: of the tile, pixels.
  TextureAxis(const OutputAxis &output, int64_t length, AxisGrid grid, bool along_pixels, const CellPlaces &places);

  // Null where the cells that begin at `corner` reach no pixel.
  const CellAxis *cells(int64_t corner, int log_size) const {
    const Cells &all = cells_[log_size - kTextureLeast];
    const int64_t index = (corner >> log_size) - all.first;
    if (index < 0 || index >= int64_t(all.axes.size()) || all.axes[index].count == 0) return nullptr;
    return &all.axes[index];
  }
  const float *values() const { return values_.data(); }
  const std::vector<float> &all() const { return values_; }

 private:
  struct Cells {
    int64_t first = 0;
    std::vector<CellAxis> axes;
  };
  struct Edges {
    double begin;
    int side;
    bool hard_low, hard_high;
    bool is_last;  // no cell follows
  };
  struct Shared {
    int64_t at = -1, stride = 0;
  };

  double weight(double offset) const;
  std::pair<double, double> seen(double middle, double low, double high) const;
  double total(double middle) const;
  CellAxis cell_axis(int64_t index, int log_size);
  // Appends the values at `count` pixels; returns their stride.
  int64_t write_table(const Edges &edges, int64_t first, int64_t count);

  OutputAxis output_;
  bool separate_;
  double begin_, end_;  // of cells, in the tile
  bool along_pixels_, shared_;
  double sigma_, step_, nodes_;                              // a pixel sees 2 nodes + 1 places around its centre
  double reach_;                                             // by which cells reach beyond their sides
  std::array<std::array<Shared, 4>, kTextureSizes> tables_;  // by size and hard edges
  std::array<Cells, kTextureSizes> cells_;
  std::vector<double> totals_;  // by pixel
  std::vector<float> values_;
};

}  // namespace sgi
