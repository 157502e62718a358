// What a prediction of seeds sees of a picture, from arrays.
#pragma once
#include <utility>

#include "bindings/arrays.hpp"
#include "bitstream/tree_walk.hpp"

namespace sgi {

using BaseLayer = Array<const int64_t, 3>;  // [C, rows, columns]

inline TreeScenery scenery_of(std::pair<int64_t, int64_t> size, const BaseLayer &base, int64_t cell, int quality) {
  const auto [width, height] = size;
  require(width >= 1 && height >= 1 && width <= 1 << 24 && height <= 1 << 24 && cell >= 0,
          "sides 1..2**24, cell from 0");
  return {width, height, base.data(), int64_t(base.shape(0)), int64_t(base.shape(1)), int64_t(base.shape(2)),
          cell,  quality};
}

}  // namespace sgi
