#include "model/colours.hpp"

namespace sgi {

// Numbers, so that all machines draw with the same ones: the floats nearest to these roots.
std::vector<float> sample_mix(const ModelSpec &spec) {
  if (spec.channels < 3 || !spec.is_plain()) return {};
  constexpr float mean = 0x1.279a74p-1f;  // 1 / √3
  if (!spec.luma_space) {
    constexpr float half = 0x1.6a09e6p-1f, sixth = 0x1.a20bd8p-2f, thirds = 0x1.a20bd8p-1f;  // 1 / √2, 1 / √6, 2 / √6
    return {mean, half, -sixth, mean, 0, thirds, mean, -half, -sixth};
  }
  constexpr float red = 0x1.167dc4p+0f, green = 0x1.bd9608p-3f;    // √2 / 1.3, √2 / 6.5
  constexpr float ends = 0x1.a20bd8p-1f, middle = 0x1.f5a7cep-2f;  // √(2/3), 0.6 √(2/3)
  return {mean, red, -ends, mean, -green, middle, mean, -red, -ends};
}

}  // namespace sgi
