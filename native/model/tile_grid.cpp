#include "model/tile_grid.hpp"

#include <algorithm>

#include "model/output_axis.hpp"

namespace sgi {

namespace {

// The first output pixel whose centre is not before `place`.
int64_t reach(const OutputAxis &axis, double place) {
  int64_t low = 0, high = axis.count;
  while (low < high) {
    const int64_t middle = low + (high - low) / 2;
    if (axis.centre(middle) < place)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

// A tile that does not lie behind the one that draws `place`, at most one before it.
int64_t near(const TileAxis &axis, double place) {
  const double size = double(axis.length) / double(axis.count);
  return int64_t(std::clamp(place / size, -2.0, double(axis.count) + 2.0));
}

}  // namespace

std::vector<TileSegment> TileAxis::segments(double start, double scale, int64_t first, int64_t count) const {
  const OutputAxis centres(start, scale, first, count);
  const auto lowest = [&](double place) { return std::max<int64_t>(0, near(*this, place) - 1); };
  const int64_t end = std::max<int64_t>(0, std::min(near(*this, centres.centre(count - 1)) + 2, this->count - 1));
  std::vector<TileSegment> found;
  int64_t begin = 0, index = lowest(centres.centre(0));
  while (index < end) {
    const int64_t border = edge(index + 1);
    const int64_t before = reach(centres, double(border - apron)), behind = reach(centres, double(border + apron));
    if (before > begin) found.push_back({begin, before, index, {}});
    if (behind > before) {
      TileSegment fade{before, behind, index, std::vector<float>(size_t(behind - before))};
      for (int64_t i = before; i < behind; ++i)
        fade.weight[size_t(i - before)] = float((centres.centre(i) - double(border - apron)) / double(2 * apron));
      found.push_back(std::move(fade));
    }
    begin = std::max(begin, behind);
    if (begin >= count) return found;
    index = std::max(index + 1, lowest(centres.centre(begin)));  // there may be tiles between centres
  }
  found.push_back({begin, count, end, {}});
  return found;
}

PixelRect TileGrid::rect(int64_t number) const {
  const TileAxis x = across(), y = down();
  const int64_t column = number % x.count, row = number / x.count;
  return {x.begin(column), y.begin(row), x.end(column) - x.begin(column), y.end(row) - y.begin(row)};
}

}  // namespace sgi
