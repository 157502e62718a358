// What the noise of a step is a hash of.
#pragma once
#include <cstdint>

namespace sgi {

struct NoiseKey {
  uint32_t key;
  bool negative;

  // What turns the noise's signs: 0, or all ones for the negative.
  uint32_t mirror() const { return negative ? ~uint32_t(0) : 0; }
};

}  // namespace sgi
