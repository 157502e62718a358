// The parts of a tile's payload in their order, and the check at its end.
#pragma once

namespace sgi {

enum class Part {
  steps,
  base,
  positions,
  decoders,
  hash_grid,
  context_model,
  colour,
  shape,
  feature,
  scales,
  offset,
  restoration,
  texture,
  check
};
constexpr int kParts = 14;

}  // namespace sgi
