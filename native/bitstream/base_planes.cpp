#include "bitstream/base_planes.hpp"

#include <algorithm>

namespace sgi {
namespace {

int64_t predict(int predictor, int64_t west, int64_t north, int64_t northwest) {
  switch (predictor) {
    case 0: return west;
    case 1: return north;
    case 2: return (west + north) >> 1;
    default: {
      const int64_t low = std::min(west, north), high = std::max(west, north);
      return (2 * std::clamp(west + north - northwest, low, high) + west + north + 2) >> 2;
    }
  }
}

}  // namespace

int64_t base_prediction(const int64_t *plane, int64_t columns, int64_t x, int64_t y, int predictor) {
  const int64_t *at = plane + y * columns + x;
  const int64_t west = x ? at[-1] : y ? at[-columns] : 0, north = y ? at[-columns] : west;
  return predict(predictor, west, north, x && y ? at[-columns - 1] : x ? west : north);
}

bool add_predictions(int64_t *plane, int64_t rows, int64_t columns, int predictor, int64_t most) {
  for (int64_t y = 0; y < rows; ++y)
    for (int64_t x = 0; x < columns; ++x) {
      int64_t &value = plane[y * columns + x];
      value += base_prediction(plane, columns, x, y, predictor);
      if (value > most || value < -most) return false;
    }
  return true;
}

}  // namespace sgi
