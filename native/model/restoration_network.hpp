// The networks that restore drawn pixels (docs/format.md, "Restoration").
#pragma once
#include <cstdint>
#include <vector>

#include "base/bytes.hpp"
#include "model/restoration_kernel.hpp"

namespace sgi {

struct RestorationLayer {
  int inputs, outputs, shift;
  std::vector<int32_t> weights, biases, squares;  // as a LayerView has them; no squares where they are not used

  LayerView view() const;
  int weight(int output, int input, int tap) const;
};

struct RestorationNetwork {
  std::vector<RestorationLayer> layers;
  int shift;  // of what the last layer gives

  int reach() const { return int(layers.size()); }  // pixels on each side that a correction depends on
};

// Of such a file. Throws std::logic_error for one that does not hold a network, or whose sums might not fit.
RestorationNetwork parse_restoration(Bytes file);

}  // namespace sgi
